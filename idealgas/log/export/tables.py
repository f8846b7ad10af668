"""CSV and Parquet by pyarrow, a block of rows at a time."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np

from idealgas.events import EVENT_COLUMNS, POSITION, EventBatch, Kind, columns_named, empty_batch
from idealgas.log.reader import Log
from idealgas.log.replay import LogState

Columns = dict[str, np.ndarray]
_PARTS = {column.name: column.parts for column in EVENT_COLUMNS if column.parts}


def write_csv_events(log: Log, path: Path) -> int:
    """One row for each event row."""
    return _write(path, _event_columns(log), _csv_writer)


def write_csv_frames(log: Log, times: Sequence[float], path: Path) -> int:
    """One row for each disc and time."""
    _write(path, _frame_columns(log, times), _csv_writer)
    return len(times)


def write_parquet_events(log: Log, path: Path) -> int:
    """One row for each event row."""
    return _write(path, _event_columns(log), _parquet_writer)


def write_parquet_frames(log: Log, times: Sequence[float], path: Path) -> int:
    """One row for each disc and time."""
    _write(path, _frame_columns(log, times), _parquet_writer)
    return len(times)


def _csv_writer(path: Path, schema: Any) -> AbstractContextManager[Any]:
    from pyarrow import csv

    return csv.CSVWriter(str(path), schema)


def _parquet_writer(path: Path, schema: Any) -> AbstractContextManager[Any]:
    from pyarrow import parquet

    return parquet.ParquetWriter(str(path), schema)


def _write(path: Path, blocks: Iterable[Columns], make_writer: Callable[[Path, Any], Any]) -> int:
    """The first of the blocks, which may be empty, names the columns."""
    import pyarrow

    writer, rows = None, 0
    try:
        for columns in blocks:
            table = pyarrow.table(columns)
            writer = writer or make_writer(path, table.schema)
            writer.write_table(table)
            rows += len(table)
    finally:
        if writer is not None:
            writer.close()
    return rows


def _event_columns(log: Log) -> Iterator[Columns]:
    kinds = np.array([kind.name.lower() for kind in Kind])
    empty = empty_batch(0, columns_named(log.columns))
    for block in (empty,) if not len(log) else log.chunks():
        columns = _flat(block)
        yield columns | {"kind": kinds[columns["kind"]]}


def _frame_columns(log: Log, times: Sequence[float]) -> Iterator[Columns]:
    ids, names = np.arange(len(log.discs), dtype=np.uint32), np.array(log.discs.species_names)[log.discs.species]
    for state in log.frames(times):
        columns = _flat(state)
        if not log.has_positions:
            for part in POSITION.parts:
                del columns[part]
        time = np.full(len(ids), columns.pop("time"))
        yield {"time": time, "disc": ids, "species": names, **columns}


def _flat(block: EventBatch | LogState) -> Columns:
    """Columns of one number a row."""
    columns: Columns = {}
    for name, values in block._asdict().items():
        if name in _PARTS and values is not None:
            columns |= dict(zip(_PARTS[name], np.ascontiguousarray(values.T), strict=True))
        elif values is not None:
            columns[name] = values
    return columns
