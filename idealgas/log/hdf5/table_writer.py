"""Tables of columns that grow together: rows of any number in, whole chunks out."""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

import h5py
import numpy as np
from isal import isal_zlib

from idealgas.log.hdf5 import chunks
from idealgas.log.hdf5.column import StoredColumn
from idealgas.log.hdf5.commit import DATASET, Commit, table_of
from idealgas.log.hdf5.safe_hdf5 import open_dataset


class TableWriter:
    """Columns of one row count that grow together: rows of any number in, whole chunks out.

    whole: rows in full chunks. fill: rows of the growing chunk. tail: those of them that are in the file.
    """

    def __init__(self, columns: Mapping[str, StoredColumn], commit: Commit, rows: int) -> None:
        """Continue after the first `rows` rows of those that `commit` says are in the file."""
        self.columns = dict(columns)
        self.chunk = next(iter(columns.values())).chunk[0]
        self.whole = rows // self.chunk * self.chunk
        self.fill = self.tail = rows - self.whole
        self._plain = False  # the growing chunk lies plain in the file
        self._pending = [np.zeros(column.chunk, column.dtype) for column in columns.values()]
        if self.fill:
            for (path, column), pending in zip(columns.items(), self._pending, strict=True):
                with _named(path):
                    committed = column.read(self.whole, commit.rows[table_of(path)], commit.tails[path])
                pending[: self.fill] = committed[: self.fill]

    def append(self, start: int, stop: int, data: Sequence[np.ndarray]) -> None:
        """Take rows `start` to `stop` of each column's data; store every chunk that becomes full.

        What lies before them may be overwritten: where there is room for the rows of the growing chunk, those are put
        there, rather than all of the new ones behind the old.
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
        """Store a chunk that became full, and begin the next."""
        self._write(data, self.chunk)
        for pending in self._pending:
            pending[: self.fill] = 0
        self.whole += self.chunk
        self.fill = self.tail = 0
        self._plain = False

    def store_tail(self, last: bool = False) -> None:
        """Put the growing chunk into the file: plain, to be rewritten in place as it grows, unless it is the last."""
        if self.tail != self.fill:
            self._plain |= not last
            self._write(self._pending, self.fill)
            self.tail = self.fill

    def trim(self) -> None:
        """Drop what the file has beyond the last row, and the torn end of a chunk that was being rewritten.

        HDF5 is not left to cut within a chunk: it forgets the filter mask of one written past it.
        """
        for column in self.columns.values():
            if column.extent > self.whole + self.fill:
                column.resize(self.whole)
        if self.fill:
            self._plain = True
            self._write(self._pending, self.fill)

    @property
    def stored(self) -> int:
        """Rows in the file."""
        return self.whole + self.tail

    def checksums(self) -> dict[str, int]:
        """CRC-32 of each column's stored rows in the growing chunk, 0 without any."""
        return {
            path: isal_zlib.crc32(pending[: self.tail]) if self.tail else 0
            for path, pending in zip(self.columns, self._pending, strict=True)
        }

    def _write(self, data: Sequence[np.ndarray], rows: int) -> None:
        for column, values in zip(self.columns.values(), data, strict=True):
            column.write(self.whole, rows, values, self._plain)


@contextmanager
def _named(path: str) -> Iterator[None]:
    """Let an error say which dataset it is about."""
    try:
        yield
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise ValueError(f"{path}: {error.args[0] if error.args else error}") from error


def open_tables(file: h5py.File, commit: Commit, keep: Mapping[str, int]) -> dict[str, TableWriter]:
    """The tables of a file, ready to grow after the first `keep` rows of each.

    To be called before SWMR mode, in which HDF5 retries indefinitely where an index is damaged.
    """
    columns: dict[str, dict[str, StoredColumn]] = {name: {} for name in commit.rows}
    encoder = chunks.Encoder()
    for path in commit.tails:
        with _named(path):
            columns[table_of(path)][path] = column = StoredColumn(open_dataset(file, path), encoder)
            column.id.get_num_chunks()  # reads the whole index
    return {name: TableWriter(columns[name], commit, rows) for name, rows in keep.items()}


def commit_tables(file: h5py.File, tables: Mapping[str, TableWriter], sequence: int, fsync: bool = False) -> None:
    """Flush the file, and then let the commit record say what it holds."""
    descriptor = file.id.get_vfd_handle()
    file.flush()
    if fsync:
        os.fsync(descriptor)
    rows = {name: table.stored for name, table in tables.items()}
    tails = {path: crc for table in tables.values() for path, crc in table.checksums().items()}
    Commit(sequence, os.fstat(descriptor).st_size, rows, tails).write(open_dataset(file, DATASET))
    if fsync:
        os.fsync(descriptor)
