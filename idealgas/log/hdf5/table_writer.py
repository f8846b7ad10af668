"""Writing tables: rows in batches of any size are stored in whole chunks."""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

import h5py
import numpy as np
from isal import isal_zlib

from idealgas.log.hdf5 import chunks
from idealgas.log.hdf5.column import StoredColumn
from idealgas.log.hdf5.commit import DATASET, Commit, table_of


class TableWriter:
    """Writes a table, columns with the same number of rows, in whole chunks.

    Attributes:
        columns: datasets, by path.
        chunk: number of rows in a chunk.
        whole: number of rows in full chunks.
        fill: number of rows in the last chunk, which is not full.
        tail: number of these that are in the file.
    """

    def __init__(self, columns: Mapping[str, StoredColumn], commit: Commit, rows: int) -> None:
        """Continue after the first `rows` of the committed rows."""
        self.columns = dict(columns)
        self.chunk = next(iter(columns.values())).chunk[0]
        self.whole = rows // self.chunk * self.chunk
        self.fill = self.tail = rows - self.whole
        self._plain = False  # whether the last chunk is uncompressed in the file
        self._pending = [np.zeros(column.chunk, column.dtype) for column in columns.values()]
        if self.fill:
            for (path, column), pending in zip(columns.items(), self._pending, strict=True):
                with _named(path):
                    committed = column.read(self.whole, commit.rows[table_of(path)], commit.tails[path])
                pending[: self.fill] = committed[: self.fill]

    def append(self, start: int, stop: int, data: Sequence[np.ndarray]) -> None:
        """Append rows `start` to before `stop` of each column's data, and write every chunk that becomes full.

        Rows before `start` may be overwritten: if the pending rows fit there, they are copied in front of the new ones,
        instead of all new ones behind them.
        """
        while start < stop:
            some = min(stop - start, self.chunk - self.fill)
            fill, start = self.fill, start + some
            if fill + some == self.chunk and start >= self.chunk:
                full = [column[start - self.chunk : start] for column in data]
                for pending, column in zip(self._pending, full, strict=True):
                    column[:fill] = pending[:fill]
                self._close_chunk(full)
                continue
            for pending, column in zip(self._pending, data, strict=True):
                pending[fill : fill + some] = column[start - some : start]
            self.fill += some
            if self.fill == self.chunk:
                self._close_chunk(self._pending)

    def _close_chunk(self, data: Sequence[np.ndarray]) -> None:
        """Write a full chunk and begin the next one."""
        self._write(data, self.chunk)
        for pending in self._pending:
            pending[: self.fill] = 0
        self.whole += self.chunk
        self.fill = self.tail = 0
        self._plain = False

    def store_tail(self, last: bool = False) -> None:
        """Write the growing chunk, uncompressed, so that it can be rewritten in place.

        last: whether it will not grow further, so that it can be compressed.
        """
        if self.tail != self.fill:
            self._plain |= not last
            self._write(self._pending, self.fill)
            self.tail = self.fill

    def trim(self) -> None:
        """Remove rows beyond the last one from the file, and rewrite a chunk whose writing was interrupted.

        Datasets are cut before that chunk: HDF5 loses the filter mask of a directly written chunk in which it cuts.
        """
        for column in self.columns.values():
            if column.extent > self.whole + self.fill:
                column.resize(self.whole)
        if self.fill:
            self._plain = True
            self._write(self._pending, self.fill)

    @property
    def stored(self) -> int:
        """Number of rows in the file."""
        return self.whole + self.tail

    def checksums(self) -> dict[str, int]:
        """CRC-32 of each column's stored rows in the growing chunk, by path; 0 if it has no rows."""
        return {
            path: isal_zlib.crc32(pending[: self.tail]) if self.tail else 0
            for path, pending in zip(self.columns, self._pending, strict=True)
        }

    def _write(self, data: Sequence[np.ndarray], rows: int) -> None:
        for column, values in zip(self.columns.values(), data, strict=True):
            column.write(self.whole, rows, values, self._plain)


@contextmanager
def _named(path: str) -> Iterator[None]:
    """Add the path of the dataset to the message of an error."""
    try:
        yield
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise ValueError(f"{path}: {error.args[0] if error.args else error}") from error


def open_tables(file: h5py.File, commit: Commit, keep: Mapping[str, int]) -> dict[str, TableWriter]:
    """Writers of all tables of a file, which continue after the first `keep` rows of each.

    To be called before SWMR mode, in which HDF5 retries indefinitely where an index is damaged.
    """
    columns: dict[str, dict[str, StoredColumn]] = {name: {} for name in commit.rows}
    encoder = chunks.Encoder()
    for path in commit.tails:
        with _named(path):
            columns[table_of(path)][path] = column = StoredColumn(file, path, encoder)
            column.id.get_num_chunks()  # reads the whole index
    return {name: TableWriter(columns[name], commit, rows) for name, rows in keep.items()}


def commit_tables(file: h5py.File, tables: Mapping[str, TableWriter], sequence: int, fsync: bool = False) -> None:
    """Flush the file, and then write the commit record of its rows."""
    descriptor = file.id.get_vfd_handle()
    file.flush()
    if fsync:
        os.fsync(descriptor)
    write_commit(file, tables, sequence, os.fstat(descriptor).st_size)
    if fsync:
        os.fsync(descriptor)


def write_commit(file: h5py.File, tables: Mapping[str, TableWriter], sequence: int, size: int) -> None:
    """Write the commit record of all rows in a file. size: size of the file, bytes."""
    rows = {name: table.stored for name, table in tables.items()}
    tails = {path: crc for table in tables.values() for path, crc in table.checksums().items()}
    Commit(sequence, size, rows, tails).write(file[DATASET].id)
