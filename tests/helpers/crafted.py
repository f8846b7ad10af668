"""Crafted logs: sound ones changed by h5py, with correct checksums, so that only the values are wrong."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np
import pytest
from isal import isal_zlib

from idealgas.log import Log, LogError, open_log
from idealgas.log.hdf5.commit import Commit, table_of
from idealgas.log.hdf5.superblock import clear_consistency_flags, has_consistency_flags, lookup3
from idealgas.log.hdf5.writable_file import OPTIONS

Edit = Callable[[h5py.File], object]

WRITING_SWMR = 0b101
"""File consistency flags of a file that a writer has open in SWMR mode."""


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """A log, open for changes; one that was not closed is in that state again afterwards."""
    unclosed = has_consistency_flags(path.read_bytes()[:48])
    with path.open("r+b") as raw:
        clear_consistency_flags(raw.fileno())
    with h5py.File(path, "r+", **OPTIONS) as file:
        yield file
    if unclosed:
        with path.open("r+b") as raw:
            block = bytearray(raw.read(48))
            block[11] = WRITING_SWMR
            block[-4:] = lookup3(bytes(block[:-4])).to_bytes(4, "little")
            raw.seek(0)
            raw.write(block)


def craft(path: Path, edit: Edit, rows: dict[str, int] | None = None) -> Path:
    """Change a log in place, and update its commit record. rows: other numbers of rows for the record, by table."""
    with opened(path) as file:
        record = Commit.read(file)
        edit(file)
        if "commit" in file and isinstance(file.get("commit", getlink=True), h5py.HardLink):
            seal(file, record._replace(rows=record.rows | (rows or {})))
    return path


def seal(file: h5py.File, record: Commit) -> None:
    """Write the commit record with correct checksums, wherever they can be computed."""
    tails = {}
    for path in (name.decode() for name in file["commit"].attrs["datasets"].tolist()):
        link = file.get(path, getlink=True)
        dataset = file[path] if isinstance(link, h5py.HardLink) else None
        fits = isinstance(dataset, h5py.Dataset) and dataset.chunks and dataset.dtype.kind != "O"
        tails[path] = _tail(dataset, record.rows[table_of(path)]) if fits else 0
    for sequence in (1, 2):
        try:
            record._replace(sequence=record.sequence + sequence, tails=tails).write(file["commit"].id)
        except (ValueError, OSError):  # the record has another shape or type
            return


def _tail(dataset: h5py.Dataset, rows: int) -> int:
    whole = rows // dataset.chunks[0] * dataset.chunks[0]
    rows = min(rows, len(dataset))
    return isal_zlib.crc32(np.ascontiguousarray(dataset[whole:rows])) if whole < rows else 0


def put(path: str, index: object, value: object) -> Edit:
    """Write other values to a dataset."""
    return lambda file: file[path].__setitem__(index, value)


def swap(path: str, **options: object) -> Edit:
    """Replace a dataset by one with other options of `create_dataset`."""

    def edit(file: h5py.File) -> None:
        old = file[path]
        given = {"data": old[()], "chunks": old.chunks, "maxshape": old.maxshape, "shuffle": old.shuffle}
        given |= {"compression": old.compression, "fletcher32": old.fletcher32}
        del file[path]
        file.create_dataset(path, **(given | options))

    return edit


def link(path: str, target: object) -> Edit:
    """Replace an object by a link."""

    def edit(file: h5py.File) -> None:
        if path in file:
            del file[path]
        file[path] = target

    return edit


def read_all(log: Log) -> None:
    """Read all data of a log."""
    for name in ("attributes", "runs", "discs", "walls", "inertia", "observables", "snapshot_times", "summary"):
        getattr(log, name)
    dict(log.observables)
    list(log.checkpoints)
    rows = sum(len(block.time) for block in log.chunks())
    assert rows == len(log)
    log.state_at(log.end_time)


def read_path(path: Path) -> None:
    """Open a log and read all its data."""
    with open_log(path) as log:
        read_all(log)


def refused(path: Path) -> str:
    """The one line with which a log is refused, without its path."""
    with pytest.raises(LogError) as caught:
        read_path(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert caught.value.exit_code == 2
    return message.removeprefix(f"{path}: ")
