"""Logs as files that other programs read: tables of events or discs, and frames of all discs."""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from idealgas.files import storage_error, written
from idealgas.log.errors import LogError
from idealgas.log.export import frames, tables
from idealgas.log.reader import Log


class Format(NamedTuple):
    """A kind of file. write_events is None where it can only hold frames; both write and return the number written.

    streams: whether they write to an open binary file from its beginning to its end; the others take a path.
    """

    ending: str
    write_frames: Callable[[Log, Sequence[float], Any], int]
    write_events: Callable[[Log, Any], int] | None = None
    streams: bool = False


FORMATS = {
    "csv": Format(".csv", tables.write_csv_frames, tables.write_csv_events, streams=True),
    "parquet": Format(".parquet", tables.write_parquet_frames, tables.write_parquet_events),
    "gsd": Format(".gsd", frames.write_gsd),
    "extxyz": Format(".extxyz", frames.write_extxyz, streams=True),
    "h5md3d": Format(".h5md", frames.write_h5md3d),
}


def export(
    log: Log,
    kind: str,
    output: str | os.PathLike[str] | BinaryIO,
    times: Sequence[float] | None = None,
    force: bool = False,
) -> int:
    """Write the states at some times, or without `times` all events, to a file of one of FORMATS.

    output: a path, where the file appears when it is whole, and an existing one of its kind is replaced only with
    `force`; or an open binary file, such as a pipe, for a kind that streams. Returns the number of frames or event
    rows. Raises LogError for what this kind of file or this log does not have, or when a package is missing, and
    OutputError if the file cannot be written.
    """
    made = FORMATS[kind]
    if times is None and made.write_events is None:
        raise LogError(f"{kind} has no room for events (allowed frames; events go into csv or parquet)")
    if times is None and not log.has_events:
        raise LogError(f"{log.path}: has no events (made with log.events = false)")
    if times is not None and kind not in ("csv", "parquet") and not log.has_positions:
        raise LogError(f"{log.path}: its discs have no positions ({log.scene.run.method})")
    with _target(made, kind, output, force, log) as target:
        try:
            if times is not None:
                return made.write_frames(log, times, target)
            assert made.write_events is not None
            return made.write_events(log, target)
        except ModuleNotFoundError as error:
            raise LogError(f"{kind} needs {error.name}: pip install 'idealgas[export]'") from error


@contextmanager
def _target(
    made: Format, kind: str, output: str | os.PathLike[str] | BinaryIO, force: bool, log: Log
) -> Iterator[Path | BinaryIO]:
    """What a format writes to."""
    if isinstance(output, (str, os.PathLike)):
        with written(output, made.ending, force, [log.path]) as part:
            if not made.streams:
                yield part
                return
            with part.open("wb") as file:
                yield file
        return
    if not made.streams:
        able = ", ".join(name for name, each in FORMATS.items() if each.streams)
        raise LogError(f"{kind} needs a file of its own (allowed for a pipe {able})")
    try:
        yield output
        output.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise storage_error(Path(str(output.name)), error) from error


def frame_times(log: Log, choice: str) -> np.ndarray:
    """Times of frames: `N` of them from the start to the end of the log, or `every=DT`. LogError for anything else."""
    every, equals, text = choice.rpartition("=")
    start, end = log.start_time, log.end_time
    try:
        if equals and every == "every" and 0 < (step := float(text)) < np.inf:
            return start + step * np.arange(int((end - start) / step) + 1)
        if not equals and (number := int(text)) > 0:
            return np.linspace(start, end, number)
    except (ValueError, OverflowError, MemoryError):
        pass
    raise LogError(f"no choice of frames (got {choice}; allowed a number of them, or every=DT with a time > 0)")
