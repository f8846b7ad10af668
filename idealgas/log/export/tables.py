"""CSV and Parquet, written block by block with pyarrow."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from idealgas.log.dataframes import KIND_NAMES, Columns, flat_events, flat_states
from idealgas.log.reader import Log


def write_csv_events(log: Log, file: BinaryIO) -> int:
    """Write CSV with a row for each event row."""
    return _write(file, _event_columns(log), _csv_writer)


def write_csv_frames(log: Log, times: Sequence[float], file: BinaryIO) -> int:
    """Write CSV with a row for each disc and time."""
    _write(file, _frame_columns(log, times), _csv_writer)
    return len(times)


def write_parquet_events(log: Log, path: Path) -> int:
    """Write Parquet with a row for each event row."""
    return _write(path, _event_columns(log), _parquet_writer)


def write_parquet_frames(log: Log, times: Sequence[float], path: Path) -> int:
    """Write Parquet with a row for each disc and time."""
    _write(path, _frame_columns(log, times), _parquet_writer)
    return len(times)


def _csv_writer(file: BinaryIO, schema: Any) -> AbstractContextManager[Any]:
    from pyarrow import csv

    return csv.CSVWriter(file, schema)


def _parquet_writer(path: Path, schema: Any) -> AbstractContextManager[Any]:
    from pyarrow import parquet

    return parquet.ParquetWriter(str(path), schema)


def _write(target: Path | BinaryIO, blocks: Iterable[Columns], make_writer: Callable[[Any, Any], Any]) -> int:
    """Write blocks of rows, of which the first one, which may be empty, has the columns. Returns the number of rows."""
    import pyarrow

    writer, rows = None, 0
    try:
        for columns in blocks:
            table = pyarrow.table(columns)
            writer = writer or make_writer(target, table.schema)
            if len(table):
                writer.write_table(table)
            rows += len(table)
    finally:
        if writer is not None:
            writer.close()
    return rows


def _event_columns(log: Log) -> Iterator[Columns]:
    kinds = np.array(KIND_NAMES)
    for columns in flat_events(log.chunks(), log.columns):
        yield columns | {"kind": kinds[columns["kind"]]}


def _frame_columns(log: Log, times: Sequence[float]) -> Iterator[Columns]:
    species = np.array(log.discs.species_names)
    for columns in flat_states(log.discs, log.frames(times)):
        yield columns | {"species": species[columns["species"]]}
