"""Write tables, whose rows arrive in batches of any size and are stored in whole chunks."""

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
    """Writer of a table in whole chunks; all columns of the table have the same number of rows.

    Attributes:
        columns: datasets of the columns, by path.
        chunk: number of rows in a chunk.
        whole: number of rows in full chunks.
        fill: number of rows in the growing chunk, which is the last chunk and not yet full.
        tail: number of rows of the growing chunk that have been written to the file.
    """

    def __init__(self, columns: Mapping[str, StoredColumn], commit: Commit, rows: int) -> None:
        """Continue a table after its first `rows` rows, which are committed."""
        self.columns = dict(columns)
        self.chunk = next(iter(columns.values())).chunk[0]
        self.whole = rows // self.chunk * self.chunk
        self.fill = self.tail = rows - self.whole
        self._plain = False  # whether the growing chunk is uncompressed in the file
        self._pending = [np.zeros(column.chunk, column.dtype) for column in columns.values()]
        if self.fill:
            for (path, column), pending in zip(columns.items(), self._pending, strict=True):
                with _named(path):
                    committed = column.read(self.whole, commit.rows[table_of(path)], commit.tails[path])
                pending[: self.fill] = committed[: self.fill]

    def append(self, start: int, stop: int, data: Sequence[np.ndarray]) -> None:
        """Append the rows `start` up to, but not including, `stop` of the data, and write every chunk that fills up.

        Rows of the data before `start` may be overwritten. If the pending rows fit there, they are copied in front of
        the new rows, which is faster than copying all new rows behind the pending rows.

        Args:
            start: first row to append.
            stop: row after the last row to append.
            data: arrays of the columns, in the order of `columns`.
        """
        while start < stop:
            number = min(stop - start, self.chunk - self.fill)
            fill, start = self.fill, start + number
            if fill + number == self.chunk and start >= self.chunk:
                full = [column[start - self.chunk : start] for column in data]
                for pending, column in zip(self._pending, full, strict=True):
                    column[:fill] = pending[:fill]
                self._close_chunk(full)
                continue
            for pending, column in zip(self._pending, data, strict=True):
                pending[fill : fill + number] = column[start - number : start]
            self.fill += number
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

        Args:
            last: whether the chunk will not grow any further; it is then compressed instead.
        """
        if self.tail != self.fill:
            self._plain |= not last
            self._write(self._pending, self.fill)
            self.tail = self.fill

    def trim(self) -> None:
        """Remove all later rows from the file, and rewrite the growing chunk, which may be half written.

        Datasets are truncated at the beginning of this chunk, because HDF5 loses the filter mask of a directly written
        chunk when it truncates a dataset within the chunk.
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
        """Return the CRC-32 of the stored rows in each column's growing chunk, by path; 0 if there are no such rows."""
        return {
            path: isal_zlib.crc32(pending[: self.tail]) if self.tail else 0
            for path, pending in zip(self.columns, self._pending, strict=True)
        }

    def _write(self, data: Sequence[np.ndarray], rows: int) -> None:
        for column, values in zip(self.columns.values(), data, strict=True):
            column.write(self.whole, rows, values, self._plain)


@contextmanager
def _named(path: str) -> Iterator[None]:
    """Add the path of the dataset to the message of any error raised in the context."""
    try:
        yield
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise ValueError(f"{path}: {error.args[0] if error.args else error}") from error


def open_tables(file: h5py.File, commit: Commit, keep: Mapping[str, int]) -> dict[str, TableWriter]:
    """Return writers for the tables of a file, by name.

    Call this function before HDF5 enters SWMR mode, in which HDF5 retries indefinitely if an index is damaged.

    Args:
        file: the file.
        commit: newest commit of the file.
        keep: number of rows, by table, after which the writers continue.
    """
    columns: dict[str, dict[str, StoredColumn]] = {name: {} for name in commit.rows}
    encoder = chunks.Encoder()
    for path in commit.tails:
        with _named(path):
            columns[table_of(path)][path] = column = StoredColumn(file, path, encoder)
            column.id.get_num_chunks()  # reads the whole index, so that damage is detected here
    return {name: TableWriter(columns[name], commit, rows) for name, rows in keep.items()}


def commit_tables(file: h5py.File, tables: Mapping[str, TableWriter], sequence: int, fsync: bool = False) -> None:
    """Flush the file, and then write the commit record for its rows. fsync: whether to force both to the disk."""
    descriptor = file.id.get_vfd_handle()
    file.flush()
    if fsync:
        os.fsync(descriptor)
    write_commit(file, tables, sequence, os.fstat(descriptor).st_size)
    if fsync:
        os.fsync(descriptor)


def write_commit(file: h5py.File, tables: Mapping[str, TableWriter], sequence: int, size: int) -> None:
    """Write the commit record for all stored rows. size: size of the file, bytes."""
    rows = {name: table.stored for name, table in tables.items()}
    tails = {path: crc for table in tables.values() for path, crc in table.checksums().items()}
    Commit(sequence, size, rows, tails).write(file[DATASET].id)
