"""Sound logs and their changes through h5py; the commit record gets the checksums of the new values."""

import lzma
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np
from numpy.random import Generator

from helpers.crafted import opened, seal, swap
from helpers.log_compare import scene_of
from helpers.support import ROOT
from idealgas.log.hdf5.commit import DATASET, Commit, table_of
from idealgas.run.simulate import simulate

FOLDER = ROOT / "tests" / "cases" / "logs"
MADE = {
    "waves": ("sound", "species.0.count=56", "box.size=[12, 12]", "run.until=60"),
    "grains": ("cooling", "species.0.count=60", "run.until=100"),
    "sums": ("mixture", "run.events=3000", "log.pressure=true", "log.snapshot_every=0.5"),
}
"""Shipped scenes and overrides of the logs that the fixtures do not have."""
SOUND = ("plain", "effects", "thermal", "monte-carlo", "killed", *MADE)


@cache
def sound_log(name: str) -> bytes:
    """The bytes of a sound log: a fixture, or one that this program makes."""
    if name not in MADE:
        (path,) = FOLDER.glob(f"*-{name}.h5.xz")
        return lzma.decompress(path.read_bytes())
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "run.h5"
        simulate(scene_of(*MADE[name]), log)
        return log.read_bytes()


class Effect(NamedTuple):
    """One change of a log.

    paths: datasets of which a command must read all to be bound to refuse the log. Without any, the log obeys all
    rules, and any result is right.
    """

    what: str
    paths: tuple[str, ...] = ()


def broken(what: str, *paths: str) -> Effect:
    """A change after which these datasets break a rule."""
    return Effect(f"{what} {' '.join(paths)}", paths)


class Editor:
    """An open log; rows: of each table, as the commit record will have them."""

    def __init__(self, file: h5py.File) -> None:
        self.file, record = file, Commit.read(file)
        self.rows, self.paths = dict(record.rows), list(record.tails)

    def datasets(self) -> list[str]:
        """Paths of all datasets but the commit record, in order."""
        found: list[str] = []
        self.file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
        return sorted({*found, *self.paths} - {DATASET})

    def with_rows(self, kinds: str, least: int = 1) -> list[str]:
        """Datasets of some kinds of NumPy types that have at least so many rows."""
        return [
            path
            for path in self.datasets()
            if self.file[path].dtype.kind in kinds and self.file[path].chunks and self.length(path) >= least
        ]

    def length(self, path: str) -> int:
        """Number of committed rows, or of all rows of a dataset that is in no table."""
        return self.rows[table_of(path)] if path in self.paths else len(self.file[path])

    def values(self, path: str) -> np.ndarray:
        """The committed rows, to be changed and stored."""
        return self.file[path][: self.length(path)]

    def store(self, path: str, values: np.ndarray) -> None:
        """Other values in a dataset."""
        if len(values):
            self.file[path][: len(values)] = values

    def remake(self, path: str, values: np.ndarray) -> None:
        """The dataset again, with another type, shape or number of rows."""
        old = self.file[path]
        fixed = old.maxshape == old.shape
        chunks = values.shape if fixed else (old.chunks[0], *values.shape[1:])
        swap(path, data=values, chunks=chunks, maxshape=values.shape if fixed else (None, *values.shape[1:]))(self.file)

    def drop(self, path: str) -> None:
        """Remove the dataset, and its entry in the commit record."""
        del self.file[path]
        if path in self.paths:
            self.paths.remove(path)
            del self.file[DATASET]
            Commit.create(self.file, self.paths)

    def seal(self) -> None:
        """Write the commit record."""
        if DATASET in self.file:
            record = Commit.read(self.file)
            seal(self.file, record._replace(rows={table: self.rows[table] for table in record.rows}))


@contextmanager
def edited(path: Path, name: str) -> Iterator[Editor]:
    """Put a sound log at a path, and yield it for changes."""
    path.write_bytes(sound_log(name))
    with opened(path) as file:
        editor = Editor(file)
        yield editor
        editor.seal()


Change = Callable[[Editor, Generator], Effect | None]
"""A change takes a log and random numbers; None where the log lacks what it changes."""


def some(random: Generator, items: list[Any]) -> Any:
    """One of the items, or None of none."""
    return items[random.integers(len(items))] if items else None
