"""CSV and Parquet, written block by block with pyarrow."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from idealgas.log.dataframes import KIND_NAMES, Columns, flat_discs, flat_events
from idealgas.log.reader import Log


def write_csv(log: Log, times: Sequence[float] | None, file: BinaryIO) -> int:
    """Write CSV with a row for each disc and time, or for each event row."""
    from pyarrow import csv

    return _write(log, times, partial(csv.CSVWriter, file))


def write_parquet(log: Log, times: Sequence[float] | None, path: Path) -> int:
    """Write Parquet with a row for each disc and time, or for each event row."""
    from pyarrow import parquet

    return _write(log, times, partial(parquet.ParquetWriter, str(path)))


def _write(log: Log, times: Sequence[float] | None, make_writer: Callable[[Any], Any]) -> int:
    """Write blocks of rows, of which the first one, which may be empty, has the columns."""
    import pyarrow

    writer, rows = None, 0
    try:
        for columns in _event_columns(log) if times is None else _frame_columns(log, times):
            table = pyarrow.table(columns)
            writer = writer or make_writer(table.schema)
            if len(table):
                writer.write_table(table)
            rows += len(table)
    finally:
        if writer is not None:
            writer.close()
    return rows if times is None else len(times)


def _event_columns(log: Log) -> Iterator[Columns]:
    kinds = np.array(KIND_NAMES)
    for columns in flat_events(log.chunks(), log.columns):
        yield columns | {"kind": kinds[columns["kind"]]}


def _frame_columns(log: Log, times: Sequence[float]) -> Iterator[Columns]:
    species = np.array(log.discs.species_names)
    for columns in flat_discs(log.discs, log.frames(times)):
        yield columns | {"species": species[columns["species"]]}
