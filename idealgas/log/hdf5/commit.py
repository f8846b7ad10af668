"""The commit record: how many rows of each table hold.

Two slots are written in turn, each with its own checksum, always after the rows they speak of. Whatever moment a writer
dies at, one slot is whole, and what it promises is in the file. A table's last chunk, while not full, is rewritten in
place as it grows; its committed rows stay the same bytes, so their CRC-32, kept here too, holds at any moment.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Self

import h5py
import numpy as np
from isal import isal_zlib

from idealgas.log.hdf5 import chunks
from idealgas.log.hdf5.column import StoredColumn
from idealgas.log.hdf5.safe_hdf5 import attribute, open_dataset

DATASET = "commit"


class Commit(NamedTuple):
    """One state of the file.

    sequence: counts the commits. file_size: bytes of the file then. rows: of each table. tails: of each dataset, the
    CRC-32 of the rows in its growing chunk, or 0.
    """

    sequence: int
    file_size: int
    rows: Mapping[str, int]
    tails: Mapping[str, int]

    @property
    def complete(self) -> bool:
        """Whether the run came to its end."""
        return self.rows["summary"] > 0

    @classmethod
    def create(cls, file: h5py.File, paths: Sequence[str]) -> None:
        """Make the record's dataset, for tables with the datasets `paths`; nothing is committed yet."""
        tables = dict.fromkeys(map(table_of, paths), 0)
        width = 2 + len(tables) + len(paths) + 1
        dataset = file.create_dataset(DATASET, (2, width), "u8", chunks=(1, width), fletcher32=True)
        dataset.attrs["datasets"] = np.array([path.encode() for path in paths])
        for sequence in range(2):
            cls(sequence, 0, tables, dict.fromkeys(paths, 0)).write(dataset.id)

    def write(self, dataset: h5py.h5d.DatasetID) -> None:
        """Put the record into the slot whose turn it is."""
        slot = np.array([self.sequence, self.file_size, *self.rows.values(), *self.tails.values(), 0], "u8")
        slot[-1] = isal_zlib.crc32(slot[:-1])
        dataset.write_direct_chunk((self.sequence % 2, 0), chunks.Encoder().plain(slot), 0)

    @classmethod
    def read(cls, file: h5py.File) -> Self:
        """The newest whole record. Raises ValueError when neither slot is."""
        dataset = open_dataset(file, DATASET)
        paths = [path.decode() for path in attribute(dataset, "datasets").tolist()]
        tables = list(dict.fromkeys(map(table_of, paths)))
        stored, width = StoredColumn(dataset), 2 + len(tables) + len(paths) + 1
        if (stored.dtype, stored.shape, stored.chunk) != (np.dtype("u8"), (2, width), (1, width)):
            raise ValueError(f"{DATASET}: not a record of {len(paths)} datasets")
        slots = []
        for slot in range(2):
            values = stored.whole(slot, verify=False)[0]
            if isal_zlib.crc32(values[:-1]) == values[-1]:
                slots.append(values[:-1].tolist())
        if not slots:
            raise ValueError("no commit record is whole")
        sequence, size, *rest = max(slots)
        rows, tails = rest[: len(tables)], rest[len(tables) :]
        return cls(sequence, size, dict(zip(tables, rows, strict=True)), dict(zip(paths, tails, strict=True)))


def table_of(path: str) -> str:
    """Name of the table that a dataset belongs to."""
    return path.partition("/")[0]
