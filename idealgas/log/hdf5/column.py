"""A dataset of a log, read and written in whole chunks past HDF5's own filters and cache."""

import math

import h5py
import numpy as np
from isal import isal_zlib

from idealgas.log.hdf5 import chunks
from idealgas.log.hdf5.safe_hdf5 import layout_of


class StoredColumn:
    """A dataset in chunks, each as long as an entry is wide. Raises ValueError where it is none that a log has."""

    def __init__(self, dataset: h5py.h5d.DatasetID, encoder: chunks.Encoder | None = None) -> None:
        self.id = dataset
        layout = layout_of(dataset)
        self.dtype, self.shape, self.chunk = layout.dtype, layout.shape, layout.chunk
        self._encoder = encoder or chunks.Encoder()
        self.extent: int = layout.shape[0]  # asking HDF5 each time takes as long as storing some planes
        self._compressed = layout.compressed
        self._origin = (0,) * (len(self.chunk) - 1)

    def read(self, start: int, rows: int, tail: int = 0) -> np.ndarray:
        """Those of the first `rows` rows that lie in the chunk at row `start`; `tail` is their CRC-32 if not all do.

        Raises whatever numpy and HDF5 raise where they are damaged or missing.
        """
        growing = rows - start < self.chunk[0]  # its own checksum fails if it was caught while being rewritten
        data = self.whole(start, verify=not growing)[: rows - start]
        if growing and isal_zlib.crc32(data) != tail:
            raise ValueError("a checksum does not match")
        return data

    def whole(self, start: int, verify: bool = True) -> np.ndarray:
        """The chunk at row `start`, with what is beyond the last row; without `verify` it may be caught half written.

        However many bytes the file says that it has, no more are read than a chunk of this size can have.
        """
        values = math.prod(self.chunk)
        room = np.empty(chunks.most_stored(values * self.dtype.itemsize), np.uint8)
        try:
            mask, stored = self.id.read_direct_chunk((start, *self._origin), out=room)
        except ValueError as error:
            raise ValueError(f"a chunk of more than {len(room):,} bytes") from error
        if not self._compressed:  # bit 0 of its pipeline is the checksum's
            mask = chunks.PLAIN
        return chunks.decode(stored, mask, self.dtype, values, verify).reshape(self.chunk)

    def write(self, start: int, rows: int, data: np.ndarray, plain: bool = False) -> None:
        """Store the chunk at row `start`, of which `rows` count. HDF5 demands that the extent grows first."""
        if self.extent < start + rows:
            self.resize(start + rows)
        offset = (start, *self._origin)
        data = np.asarray(data, self.dtype)
        if not self._compressed:
            self.id.write_direct_chunk(offset, self._encoder.plain(data), 0)
        elif plain:
            self.id.write_direct_chunk(offset, self._encoder.plain(data), chunks.PLAIN)
        else:
            self.id.write_direct_chunk(offset, self._encoder.compressed(data), chunks.COMPRESSED)

    def resize(self, rows: int) -> None:
        """Give the dataset so many rows."""
        self.id.set_extent((rows, *self.chunk[1:]))
        self.extent = rows
