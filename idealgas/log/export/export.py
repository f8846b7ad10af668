"""Export logs for other programs, as tables of events, flights or discs or as frames with all discs."""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO, Literal, NamedTuple

import numpy as np

from idealgas.errors import install, unknown
from idealgas.files import storage_error, written
from idealgas.log.errors import LogError
from idealgas.log.export import frames, tables
from idealgas.log.export.tables import Rows
from idealgas.log.reader import Log, takes_path


class Format(NamedTuple):
    """A file format.

    Attributes:
        ending: extension of file names.
        write: function that writes frames at given times, all event rows or all flights, and returns their number.
        has_events: whether the format can contain event rows and flights.
        streams: whether `write` takes an open binary file, to which it writes sequentially, instead of a path.
    """

    ending: str
    write: Callable[[Log, Any, Any], int]
    has_events: bool = False
    streams: bool = False


Kind = Literal["csv", "parquet", "gsd", "extxyz", "h5md3d"]
FORMATS: dict[Kind, Format] = {
    "csv": Format(".csv", tables.write_csv, has_events=True, streams=True),
    "parquet": Format(".parquet", tables.write_parquet, has_events=True),
    "gsd": Format(".gsd", frames.write_gsd),
    "extxyz": Format(".extxyz", frames.write_extxyz, streams=True),
    "h5md3d": Format(".h5md", frames.write_h5md3d),
}


@takes_path
def export(
    log: Log,
    kind: Kind,
    output: str | os.PathLike[str] | BinaryIO,
    times: Sequence[float] | None = None,
    force: bool = False,
    rows: Rows = "events",
    parts: int | None = None,
) -> int:
    """Write the states at given times, all events or all flights to a file.

    Args:
        log: log to export, or its path.
        kind: name of a format in FORMATS.
        output: path of the file, which appears there once it is complete; or, for a format that streams, an open binary
            file such as a pipe.
        times: times of the frames in increasing order; None to export events or flights.
        force: whether to overwrite an existing file of the same format.
        rows: "events", or "flights" for the motion of each disc from one of its events to the next.
        parts: number of Parquet files into which events or flights are divided by time; `output` is then a new folder.

    Returns:
        Number of frames or rows written.

    Raises:
        UserError: if the format or the table of rows is unknown.
        LogError: if the format or the log cannot provide the requested data, or a required package is missing.
        OutputError: if the file cannot be written.
    """
    if kind not in FORMATS:
        raise unknown("format", kind, tuple(FORMATS))
    file_format = FORMATS[kind]
    if rows not in tables.END_OF:
        raise unknown("table of rows", rows, tuple(tables.END_OF))
    if parts is not None and (kind != "parquet" or times is not None or parts < 1):
        raise LogError(f"parts must be 1 or more, and apply only to events or flights in parquet (got {parts}, {kind})")
    if times is None and not file_format.has_events:
        raise LogError(f"{kind} files cannot contain events (allowed frames; use csv or parquet for events)")
    if times is None:
        log.require_events()
    if times is not None and not file_format.has_events and not log.has_positions:
        raise LogError(f"{log.path}: its discs have no positions ({log.scene.run.method})")
    try:
        if parts is not None:
            return tables.write_parts(log, rows, Path(str(output)), parts, force)
        with _target(file_format, kind, output, force, log) as target:
            return file_format.write(log, rows if times is None else times, target)
    except ModuleNotFoundError as error:
        raise LogError(f"{kind} requires {error.name}: {install('export')}") from error


@contextmanager
def _target(
    file_format: Format, kind: Kind, output: str | os.PathLike[str] | BinaryIO, force: bool, log: Log
) -> Iterator[Path | BinaryIO]:
    """Yield the path or the open file to which a format writes."""
    if isinstance(output, (str, os.PathLike)):
        with written(output, file_format.ending, force, [log.path]) as part:
            if not file_format.streams:
                yield part
                return
            with part.open("wb") as file:
                yield file
        return
    if not file_format.streams:
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
    """Return the times of the frames that the user chose.

    Args:
        log: the log.
        choice: number of frames, evenly spaced from the start to the end of the log, or `every=DT`.

    Raises:
        LogError: if the choice is invalid.
    """
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
