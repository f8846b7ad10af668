"""Export of logs for other programs: tables of events or discs, and frames of all discs."""

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
    """A file format.

    Attributes:
        ending: file name extension.
        write_frames: function that writes frames at some times and returns their number.
        write_events: function that writes all events and returns the number of rows; None without events.
        streams: whether these functions write to an open binary file from start to end; otherwise they take a path.
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
    """Write the states at some times, or all events, to a file.

    Args:
        log: log to export.
        kind: name of one of FORMATS.
        output: path, where the file appears when it is complete; or an open binary file, such as a pipe, for a format
            that streams.
        times: times of the frames in increasing order; None for events.
        force: whether an existing file of the same format is overwritten.

    Returns:
        Number of frames or event rows.

    Raises:
        LogError: if the format or the log lacks the requested data, or a package is missing.
        OutputError: if the file cannot be written.
    """
    made = FORMATS[kind]
    if times is None and made.write_events is None:
        raise LogError(f"{kind} has no events (allowed frames; csv and parquet have events)")
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
    """Path or file for a format to write to."""
    if isinstance(output, (str, os.PathLike)):
        with written(output, made.ending, force, [log.path]) as part:
            if not made.streams:
                yield part
                return
            with part.open("wb") as file:
                yield file
        return
    if not made.streams:
        allowed = ", ".join(name for name, each in FORMATS.items() if each.streams)
        raise LogError(f"{kind} cannot be written to a pipe (allowed {allowed})")
    try:
        yield output
        output.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise storage_error(Path(str(output.name)), error) from error


def frame_times(log: Log, choice: str) -> np.ndarray:
    """Times of frames for `N`, so many from start to end of the log, or `every=DT`. Raises LogError otherwise."""
    every, equals, text = choice.rpartition("=")
    start, end = log.start_time, log.end_time
    try:
        if equals and every == "every" and 0 < (step := float(text)) < np.inf:
            return start + step * np.arange(int((end - start) / step) + 1)
        if not equals and (number := int(text)) > 0:
            return np.linspace(start, end, number)
    except (ValueError, OverflowError, MemoryError):
        pass
    raise LogError(f"invalid choice of frames (got {choice}; allowed their number, or every=DT with a time > 0)")
