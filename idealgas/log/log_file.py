"""The HDF5 file of a log, open for reading in chunks. Every failure to read it raises LogError."""

import math
import os
import time
import weakref
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import h5py
import numpy as np

from idealgas.columns import COUNTED, Column
from idealgas.files import HEAD, describe_file_type
from idealgas.locks import is_locked
from idealgas.log import schema
from idealgas.log.check_parts import box_of, check_names, check_sizes
from idealgas.log.errors import DamageError, LogError, reason
from idealgas.log.hdf5.chunks import keep_freed_memory
from idealgas.log.hdf5.column import StoredColumn
from idealgas.log.hdf5.commit import Commit, commit_of, table_of
from idealgas.log.hdf5.superblock import ReadableFile
from idealgas.log.rules import Rules

_CACHED = 64
"""Number of event chunks in the cache, which takes up to 64 MiB.

It suffices for several analyses that run together to read a log of half a million rows only once.
"""
_CACHED_SMALL = 16
"""Number of small chunks of other tables in the cache."""
_SMALL = 2**20
"""Largest size of a chunk that counts as small, bytes."""
ATTEMPTS = 10
"""Number of attempts to read bytes that a writer may be changing."""
PAUSE = 0.02
"""Time between attempts, s."""

Result = TypeVar("Result")


class StoredTable(dict[str, Any]):
    """Entries of a table in a log, by name; access to a missing entry raises DamageError."""

    def __init__(self, path: Path, table: str, entries: Mapping[str, Any]) -> None:
        super().__init__(entries)
        self._path, self._table = path, table

    def __missing__(self, name: str) -> Any:
        raise DamageError(self._path, f"{self._table}: has no {name}")


class LogFile:
    """The HDF5 file of a log, open for reading, even while a run is writing it or after the run was killed.

    Attributes:
        path: path of the file.
        unclosed: whether the file consistency flags are set, because the file is being written or its writer was
            killed.
        commit: newest commit record.
        kinds: optional kinds of events that the log may contain, and therefore counts.
        pistons: number of pistons.
        rules: rules for the values in this log.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: Any = None
        self._opened: list[Any] = []
        weakref.finalize(self, _close_all, self._opened)  # runs before Python exits, when HDF5 can still read
        self._events = lru_cache(_CACHED)(self._chunk)
        self._small_chunks = lru_cache(_CACHED_SMALL)(self._chunk)
        keep_freed_memory()
        try:
            self._read(self._open)
        except LogError:
            self.close()
            raise

    def refresh(self) -> None:
        """Read what the writer has committed since the file was opened or last refreshed."""
        self._read(self._open)
        self._events.cache_clear()
        self._small_chunks.cache_clear()

    def close(self) -> None:
        """Close the file."""
        _close_all(self._opened)
        self._file = None

    def rows(self, table: str) -> int:
        """Return the number of committed rows of a table; 0 if it is missing."""
        return self.commit.rows.get(table, 0)

    def names(self, table: str) -> list[str]:
        """Return the names of the columns of a table."""
        return self._names.get(table, [])

    def stored(self, table: str) -> list[Column]:
        """Return the columns of a table as stored in the file, each with name, type and shape of an entry.

        For an H5MD element, only the values are included, without steps and times.
        """
        columns = ((name, self._columns[f"{table}/{name}"]) for name in self.names(table))
        paths = ((name.removesuffix("/value").rpartition("/")[2], name, column) for name, column in columns)
        return [
            Column(word, column.dtype.str[1:], column.chunk[1:])
            for word, name, column in paths
            if "/" not in name or name.endswith("/value")
        ]

    def chunk_rows(self, path: str) -> int:
        """Return the number of rows in a chunk of a column."""
        return self._columns[path].chunk[0]

    def chunk(self, path: str, start: int) -> np.ndarray:
        """Return the committed rows of a column in the chunk that begins at row `start`, as a read-only array."""
        if table_of(path) == "events":
            return self._events(path, start)
        column = self._columns[path]
        small = math.prod(column.chunk) * column.dtype.itemsize <= _SMALL
        return self._small_chunks(path, start) if small else self._chunk(path, start)

    def column(self, path: str, step: int = 1) -> np.ndarray:
        """Return all committed rows of a column of a short table, or every `step`-th row, starting with the first."""
        column = self._columns[path]
        starts = range(0, self.rows(table_of(path)), column.chunk[0])
        parts = [np.ascontiguousarray(self.chunk(path, start)[-start % step :: step]) for start in starts]
        return np.concatenate(parts) if parts else np.empty((0, *column.chunk[1:]), column.dtype)

    def fixed(self, name: str) -> np.ndarray:
        """Return the values of a dataset that was written before the run."""

        def read() -> np.ndarray:
            column = StoredColumn(self._file, name)
            self.rules.check_fixed(name, column)
            data = column.read(0, column.shape[0])
            self.rules.check(name, data)
            return data

        return self._read(read, f"{name}: ")

    def texts(self, name: str) -> list[str]:
        """Return the strings in a dataset that was written before the run, or in a column of a table."""
        texts = (self.column(name) if name in self._columns else self.fixed(name)).tolist()
        return self.checked(lambda: [text.decode() for text in texts], name)

    def checked(self, action: Callable[[], Result], name: str = "") -> Result:
        """Return the result of a function; if the function raises ValueError for invalid data, raise DamageError.

        Args:
            action: function to call.
            name: name of the data, which begins the error message.
        """
        return self._read(action, name and f"{name}: ")

    def attribute(self, name: str, attribute: str) -> Any:
        """Return the value of an attribute of a dataset or group."""
        return self._read(lambda: self._file[name].attrs[attribute], f"{name}: ")

    def attributes(self, name: str, wanted: Sequence[str]) -> dict[str, str | int]:
        """Return attributes of a group by name; each must be a string or an integer."""
        return self._read(lambda: {key: _text_or_integer(self._file[name], key) for key in wanted}, f"{name}: ")

    def _open(self) -> None:
        self.close()
        try:
            source = ReadableFile(self.path)
        except OSError as error:
            raise LogError(f"{self.path}: cannot be read: {error.strerror}") from error
        self._opened.append(source)
        if source.unclosed is None:
            source.seek(0)
            raise LogError(f"{self.path}: not a log of idealgas, but {describe_file_type(source.read(HEAD))}")
        self.unclosed = source.unclosed
        if not self.unclosed:
            self._check_size(os.fstat(source.fileno()).st_size, source.end)
        self._file = h5py.File(source, "r")
        self._opened.append(self._file)
        if "format" not in self._file.attrs or _text_or_integer(self._file, "format") != schema.FORMAT:
            raise LogError(f"{self.path}: not a log of idealgas, but an HDF5 file written by another program")
        version = _text_or_integer(self._file, "format_version")
        if version != schema.VERSION:
            raise LogError(f"{self.path}: has format {version}; this version of idealgas reads format {schema.VERSION}")
        self.commit = Commit.read(self._file)
        size = os.fstat(source.fileno()).st_size  # read after the commit, because a writer may be extending the file
        if self.unclosed:
            self._check_size(size, self.commit.file_size)
        self._columns = {path: self._column_at(path) for path in self.commit.tails}
        self._names: dict[str, list[str]] = {}
        for path in self.commit.tails:
            self._names.setdefault(table_of(path), []).append(path.partition("/")[2])
        self.kinds = {kind for kind, column in COUNTED.items() if column.name in self.names("checkpoints")}
        place = self._columns.get("checkpoints/piston_position")
        self.pistons = 0 if place is None else math.prod(place.chunk[1:])
        self.rules = self._rules(size)

    def _check_size(self, size: int, expected: int) -> None:
        if size < expected:
            raise DamageError(self.path, f"truncated: {size:,} of {expected:,} bytes")

    def _rules(self, size: int) -> Rules:
        """Check the tables of this log, and return the rules for its values.

        Args:
            size: size of the file, bytes.
        """
        discs, species, walls = (self._column_at(name) for name in ("discs/id", "discs/species_name", "walls/name"))
        counts = (discs.extent, species.extent, walls.extent)
        check_sizes(*counts, size)
        box = self._column_at("box")
        size_of_box = box_of(box.whole(0) if box.chunk == (2,) else np.empty(0))
        rules = Rules(size_of_box, *counts, self.kinds, self.pistons)
        for table, names in self._names.items():
            columns = {f"{table}/{name}": self._columns[f"{table}/{name}"] for name in names}
            rules.check_table(columns, self.rows(table), size)
        check_names(self._names)
        if not self.rows("runs"):
            raise ValueError("runs/scene: no rows")
        return rules

    def _column_at(self, path: str) -> StoredColumn:
        try:
            return StoredColumn(self._file, path)
        except (KeyError, ValueError) as error:
            raise ValueError(f"{path}: {reason(error)}") from error

    def _chunk(self, path: str, start: int) -> np.ndarray:
        column, rows, tail = self._columns[path], self.rows(table_of(path)), self.commit.tails[path]

        def read() -> np.ndarray:
            data = column.read(start, rows, tail)
            self.rules.check(path, data, start)
            return data

        data = self._read(read, f"{path} from row {start}: ")
        data.flags.writeable = False
        return data

    def _read(self, action: Callable[[], Result], prefix: str = "") -> Result:
        """Return the result of a function; if it fails while a writer may be changing the same bytes, try again."""
        attempt = 1
        while True:
            try:
                return action()
            except (OSError, RuntimeError, KeyError, ValueError, TypeError, IndexError) as error:
                if attempt == ATTEMPTS or not is_locked(self.path):
                    if self._was_changed():
                        raise LogError(f"{self.path}: was changed by a run while it was being read") from error
                    raise DamageError(self.path, f"{prefix}{reason(error)}") from error
            attempt += 1
            time.sleep(PAUSE)

    def _was_changed(self) -> bool:
        """Return whether a run has changed the log since the log was opened or last refreshed."""
        try:
            return commit_of(self.path) != self.commit
        except (OSError, RuntimeError, KeyError, ValueError, TypeError, IndexError, AttributeError):
            return False


def _close_all(files: list[Any]) -> None:
    """Close the files in reverse order, and empty the list."""
    while files:
        with suppress(OSError, RuntimeError):  # HDF5 may read damaged bytes even while closing a file
            files.pop().close()


def _text_or_integer(item: h5py.HLObject, name: str) -> str | int:
    """Return an attribute that is a single string or integer. Raises ValueError if it is anything else."""
    value = item.attrs[name]
    try:
        value = value.decode() if isinstance(value, bytes) else value
    except UnicodeDecodeError as error:
        raise ValueError(f"attribute {name}: not UTF-8 text") from error
    if not isinstance(value, str | np.integer):
        raise ValueError(f"attribute {name}: not a single text or integer")
    return value if isinstance(value, str) else int(value)
