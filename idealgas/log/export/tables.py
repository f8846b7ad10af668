"""Write CSV and Parquet, block by block, with pyarrow."""

import re
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, Literal

import numpy as np

from idealgas.errors import OutputError
from idealgas.files import beside, storage_error
from idealgas.log.dataframes import KIND_NAMES, Columns, flat_discs, flat_events, flat_flights
from idealgas.log.reader import Log

Rows = Literal["events", "flights"]
"""What the rows of a table describe, if not the discs at given times."""

END_OF = {"events": "time", "flights": "end"}
"""Column with the time by which the rows are sorted."""


def write_csv(log: Log, times: Sequence[float] | Rows, file: BinaryIO) -> int:
    """Write CSV with one row per disc and time, event row or flight; return the number of frames or rows."""
    from pyarrow import csv

    return _write(log, times, partial(csv.CSVWriter, file))


def write_parquet(log: Log, times: Sequence[float] | Rows, path: Path) -> int:
    """Write Parquet with one row per disc and time, event row or flight; return the number of frames or rows."""
    from pyarrow import parquet

    return _write(log, times, partial(parquet.ParquetWriter, str(path)))


def write_parts(log: Log, what: Rows, folder: Path, number: int, force: bool = False) -> int:
    """Write event rows or flights as Parquet files in a new folder, and return the number of rows.

    The duration of the log is divided into equal intervals, and each file contains the events that occur, or the
    flights that end, in one of these intervals. The folder appears once it is complete.

    Args:
        log: log to export.
        what: "events" or "flights".
        folder: path of the new folder.
        number: number of files.
        force: whether to replace an existing folder that contains only such files.

    Raises:
        OutputError: if the folder exists and may not be replaced, or cannot be written.
    """
    import pyarrow
    from pyarrow import parquet

    if folder.exists() and not force:
        raise OutputError(f"{folder}: already exists (use force=True to overwrite)")
    if folder.exists() and not (folder.is_dir() and all(map(_is_part, folder.iterdir()))):
        raise OutputError(f"{folder}: not overwritten, because it is not a folder with only export parts")
    edges = np.linspace(log.start_time, log.end_time, number + 1)[1:-1]
    place, writers, rows = beside(folder), list[Any](), 0

    def open_up_to(part: int, schema: Any) -> None:
        for k in range(len(writers), part + 1):
            if writers:
                writers[-1].close()
            writers.append(parquet.ParquetWriter(str(place / f"part-{k:04}.parquet"), schema))

    try:
        place.mkdir()
        for columns in _columns(log, what):
            table = pyarrow.table(columns)
            cuts = [0, *columns[END_OF[what]].searchsorted(edges, "right").tolist(), len(table)]
            for k in np.flatnonzero(np.diff(cuts)).tolist():
                open_up_to(k, table.schema)
                writers[-1].write_table(table.slice(cuts[k], cuts[k + 1] - cuts[k]))
            rows += len(table)
        open_up_to(number - 1, table.schema)
        writers[-1].close()
        _replace(place, folder.resolve())
    except OSError as error:
        raise storage_error(folder, error) from error
    finally:
        with suppress(OSError):
            if writers:
                writers[-1].close()
        shutil.rmtree(place, ignore_errors=True)
    return rows


def _replace(place: Path, folder: Path) -> None:
    """Rename a complete folder to its final name, and then remove any previous folder with this name."""
    if not folder.exists():
        place.rename(folder)
        return
    previous = beside(folder)
    folder.rename(previous)
    try:
        place.rename(folder)
    except OSError:
        previous.rename(folder)
        raise
    shutil.rmtree(previous)


def _is_part(path: Path) -> bool:
    return re.fullmatch(r"part-\d{4,}\.parquet", path.name) is not None


def _write(log: Log, times: Sequence[float] | Rows, make_writer: Callable[[Any], Any]) -> int:
    """Write blocks of rows. The first block, which may be empty, determines the columns of the file."""
    import pyarrow

    writer, rows = None, 0
    try:
        for columns in _columns(log, times):
            table = pyarrow.table(columns)
            writer = writer or make_writer(table.schema)
            if len(table):
                writer.write_table(table)
            rows += len(table)
    finally:
        if writer is not None:
            writer.close()
    return rows if isinstance(times, str) else len(times)


def _columns(log: Log, times: Sequence[float] | Rows) -> Iterator[Columns]:
    if not isinstance(times, str):
        return _frame_columns(log, times)
    return _flight_columns(log) if times == "flights" else _event_columns(log)


def _flight_columns(log: Log) -> Iterator[Columns]:
    """Yield the columns of uncut flights; `kind` is an empty string if a flight does not end with an event."""
    kinds, species = np.array([*KIND_NAMES, ""]), np.array(log.discs.species_names)
    for columns in flat_flights(log.flights()):
        del columns["block"]
        yield columns | {"kind": kinds[columns["kind"]], "species": species[columns["species"]]}


def _event_columns(log: Log) -> Iterator[Columns]:
    kinds = np.array(KIND_NAMES)
    for columns in flat_events(log.chunks(), log.columns):
        yield columns | {"kind": kinds[columns["kind"]]}


def _frame_columns(log: Log, times: Sequence[float]) -> Iterator[Columns]:
    species = np.array(log.discs.species_names)
    for columns in flat_discs(log.discs, log.frames(times)):
        yield columns | {"species": species[columns["species"]]}
