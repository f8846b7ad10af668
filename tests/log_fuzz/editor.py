"""A log that is changed piece by piece, and whose check sums are then made right again."""

import math
from pathlib import Path
from typing import Any, Self

import h5py
import numpy as np
from isal import isal_zlib

from idealgas.log.hdf5 import chunks
from idealgas.log.hdf5.column import StoredColumn
from idealgas.log.hdf5.commit import DATASET, Commit, table_of
from idealgas.log.hdf5.superblock import clear_mark, lookup3
from idealgas.log.hdf5.table import open_dataset
from idealgas.log.schema import FILE_OPTIONS

SUPERBLOCK, FLAGS = 48, 11
"""Bytes of an HDF5 file's first block, and the place in it of a writer's mark."""


class Editor:
    """An open log; a context manager that seals what it leaves.

    rows: of each table, as the commit record is to say. paths: the datasets that it is to list. tails: their CRC-32.
    size: of the file, as the record is to say.
    """

    def __init__(self, path: Path) -> None:
        self.path, self._mark = path, path.read_bytes()[FLAGS]
        if self._mark:
            clear_mark(path)
        self.file = h5py.File(path, "r+", **FILE_OPTIONS)
        commit = Commit.read(self.file)
        self.rows, self.tails, self.sequence = dict(commit.rows), dict(commit.tails), commit.sequence
        self.paths = list(commit.tails)
        self.size: int | None = None
        self._sealed = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._sealed:
            self.seal()
        self.file.close()
        if self._mark and self.path.is_file():
            self._mark_again()

    def datasets(self) -> list[str]:
        """Paths of all datasets but the commit record, in order."""
        found: list[str] = []
        self.file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
        return sorted({*found, *self.paths} - {DATASET})

    def length(self, path: str) -> int:
        """Rows that count: those committed, or all of a dataset that is in no table."""
        return self.rows[table_of(path)] if path in self.paths else len(self.file[path])

    def values(self, path: str) -> np.ndarray:
        """The rows that count, to be changed and stored."""
        column, rows = StoredColumn(open_dataset(self.file, path)), self.length(path)
        if not rows:
            return np.empty((0, *column.chunk[1:]), column.dtype)
        return np.concatenate([self._chunk(column, start)[: rows - start] for start in range(0, rows, column.chunk[0])])

    def store(self, path: str, values: np.ndarray) -> None:
        """Other values in a dataset that stays what it is."""
        column = StoredColumn(open_dataset(self.file, path))
        size = column.chunk[0]
        for start in range(0, len(values), size):
            whole = np.zeros(column.chunk, column.dtype)
            part = values[start : start + size]
            whole[: len(part)] = part
            column.write(start, len(part), whole)
        self._note(path, np.asarray(values, column.dtype), size)

    def remake(self, path: str, values: np.ndarray, *, dtype: Any = None, **options: Any) -> None:
        """The dataset anew, of another type, shape or layout. options: of h5py's `create_dataset`; None for none."""
        old = self.file[path]
        unit, chunk = dict(old.attrs), old.chunks
        dtype = values.dtype if dtype is None else dtype
        shape = values.shape
        given = {"chunks": (chunk[0], *shape[1:]), "maxshape": (None, *shape[1:]), "fletcher32": True, "shuffle": True}
        given = {"compression": "gzip", "compression_opts": 1, **given} | options if shape else {}
        del self.file[path]
        made = self.file.create_dataset(path, shape, dtype, **{k: v for k, v in given.items() if v is not None})
        if values.size:
            made[...] = values
        for name, value in unit.items():
            made.attrs[name] = value
        if shape and values.dtype.kind in "iufbS" and path in self.paths:
            size = (given["chunks"] or shape)[0]
            stored = np.asarray(values, made.dtype) if made.dtype.kind in "iufbS" else values
            self._note(path, stored, size)

    def raw(self, path: str, stored: bytes, mask: int = chunks.COMPRESSED) -> None:
        """Other bytes in the first chunk of a dataset, as they are."""
        dataset = open_dataset(self.file, path)
        origin = (0,) * dataset.rank
        dataset.write_direct_chunk(origin, stored + b"\0", mask)  # HDF5 keeps the mask of a chunk that keeps its size
        dataset.write_direct_chunk(origin, stored, mask)

    def drop(self, path: str) -> None:
        """Take the dataset away, and off the list."""
        del self.file[path]
        if path in self.paths:
            self.paths.remove(path)
            del self.tails[path]

    def seal(self) -> None:
        """Write the commit record anew, in both slots; nobody is to do it again."""
        self._sealed = False
        if DATASET not in self.file:
            return
        listed = [path.decode() for path in self.file[DATASET].attrs["datasets"]]
        if listed != self.paths:
            del self.file[DATASET]
            Commit.create(self.file, self.paths)
        self.file.flush()
        size = 0 if self.size is None else self.size
        tables = {table_of(path): self.rows[table_of(path)] for path in self.paths}
        for sequence in (1, 2):
            record = Commit(self.sequence + sequence, size, tables, {path: self.tails[path] for path in self.paths})
            record.write(open_dataset(self.file, DATASET))

    def _mark_again(self) -> None:
        """The log is once more one whose writer died."""
        with self.path.open("r+b") as file:
            block = bytearray(file.read(SUPERBLOCK))
            block[FLAGS] = self._mark
            block[-4:] = lookup3(bytes(block[:-4])).to_bytes(4, "little")
            file.seek(0)
            file.write(block)

    def leave_unsealed(self) -> None:
        """The commit record stays as it is now."""
        self._sealed = False

    def _note(self, path: str, values: np.ndarray, size: int) -> None:
        if path in self.paths:
            growing = values[len(values) // size * size :]
            self.tails[path] = isal_zlib.crc32(np.ascontiguousarray(growing)) if len(growing) else 0

    def _chunk(self, column: StoredColumn, start: int) -> np.ndarray:
        mask, stored = column.id.read_direct_chunk((start, *(0,) * (len(column.chunk) - 1)))
        if column.id.get_create_plist().get_filter_by_id(h5py.h5z.FILTER_DEFLATE) is None:
            mask = chunks.PLAIN
        values = chunks.decode(stored, mask, column.dtype, math.prod(column.chunk), verify=False)
        return values.reshape(column.chunk).copy()
