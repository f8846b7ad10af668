"""The commit record, which contains the number of committed rows in each table.

Two slots with checksums are written alternately, always after the rows that they count. Whenever a writer is killed, at
least one slot is complete, and the rows that it counts are in the file. The last chunk of a table is rewritten in place
until it is full. The bytes of the committed rows in this chunk do not change, so their CRC-32, which is also in the
record, remains valid.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, Self

import h5py
import numpy as np
from isal import isal_zlib

from idealgas.log.hdf5 import chunks
from idealgas.log.hdf5.column import StoredColumn
from idealgas.log.hdf5.superblock import ReadableFile

DATASET = "commit"


class Commit(NamedTuple):
    """A commit record.

    Attributes:
        sequence: sequence number of the commit.
        file_size: size of the file at the commit, bytes.
        rows: number of committed rows, by table.
        tails: CRC-32 of the committed rows in the last chunk, by path of the dataset; 0 if the chunk is full.
    """

    sequence: int
    file_size: int
    rows: Mapping[str, int]
    tails: Mapping[str, int]

    @property
    def complete(self) -> bool:
        """Whether the run reached its end."""
        return self.rows["summary"] > 0

    @classmethod
    def create(cls, file: h5py.File, paths: Sequence[str]) -> None:
        """Create the dataset for the record, with no committed rows. paths: paths of the datasets of all tables."""
        tables = dict.fromkeys(map(table_of, paths), 0)
        width = 2 + len(tables) + len(paths) + 1
        dataset = file.create_dataset(DATASET, (2, width), "u8", chunks=(1, width), fletcher32=True)
        dataset.attrs["datasets"] = np.array([path.encode() for path in paths])
        for sequence in range(2):
            cls(sequence, 0, tables, dict.fromkeys(paths, 0)).write(dataset.id)

    def write(self, dataset: h5py.h5d.DatasetID) -> None:
        """Write the record to the slot determined by its sequence number."""
        slot = np.array([self.sequence, self.file_size, *self.rows.values(), *self.tails.values(), 0], "u8")
        slot[-1] = isal_zlib.crc32(slot[:-1])
        dataset.write_direct_chunk((self.sequence % 2, 0), chunks.Encoder().plain(slot), 0)

    @classmethod
    def read(cls, file: h5py.File) -> Self:
        """Return the newest complete record. Raises ValueError if neither slot is complete."""
        stored = StoredColumn(file, DATASET)
        names = np.asarray(file[DATASET].attrs["datasets"])
        if names.ndim != 1 or names.dtype.kind != "S":
            raise ValueError(f"{DATASET}: attribute datasets: not a list of texts")
        paths = [path.decode() for path in names.tolist()]
        tables = list(dict.fromkeys(map(table_of, paths)))
        width = 2 + len(tables) + len(paths) + 1
        if (stored.dtype, stored.shape, stored.chunk) != (np.dtype("u8"), (2, width), (1, width)):
            raise ValueError(f"{DATASET}: not a record of {len(paths)} datasets")
        slots = []
        for slot in range(2):
            values = stored.whole(slot, verify=False)[0]
            if isal_zlib.crc32(values[:-1]) == values[-1]:
                slots.append(values[:-1].tolist())
        if not slots:
            raise ValueError("no complete commit record")
        sequence, size, *numbers = max(slots)
        rows, tails = numbers[: len(tables)], numbers[len(tables) :]
        return cls(sequence, size, dict(zip(tables, rows, strict=True)), dict(zip(paths, tails, strict=True)))


def commit_of(path: Path) -> Commit:
    """Return the newest commit of a file, which may be in use. Raises the errors of h5py and of `Commit.read`."""
    with ReadableFile(path) as source, h5py.File(source, "r") as file:
        return Commit.read(file)


def table_of(path: str) -> str:
    """Return the name of the table to which a dataset belongs."""
    return path.partition("/")[0]
