"""A dataset of a log, read and written in whole chunks, without HDF5's own filters and cache."""

import math

import h5py
import numpy as np
from isal import isal_zlib

from idealgas.log.hdf5 import chunks
from idealgas.log.hdf5.safe_hdf5 import layout_of


class StoredColumn:
    """A dataset whose chunks divide only its first axis.

    Attributes:
        dtype: type of its values.
        shape: shape of the dataset when it was opened.
        chunk: shape of a chunk.
        extent: number of rows.
    """

    def __init__(self, dataset: h5py.h5d.DatasetID, encoder: chunks.Encoder | None = None) -> None:
        """Check the layout of a dataset. Raises ValueError for one that no log has."""
        self.id = dataset
        layout = layout_of(dataset)
        self.dtype, self.shape, self.chunk = layout.dtype, layout.shape, layout.chunk
        self._encoder = encoder or chunks.Encoder()
        self.extent: int = layout.shape[0]  # asking HDF5 each time takes as long as storing some planes
        self._compressed = layout.compressed
        self._origin = (0,) * (len(self.chunk) - 1)

    def read(self, start: int, rows: int, tail: int = 0) -> np.ndarray:
        """Committed rows of the chunk that begins at row `start`.

        Damaged or missing chunks raise the errors of NumPy and HDF5.

        Args:
            start: first row of the chunk.
            rows: number of committed rows of the dataset.
            tail: CRC-32 of the committed rows in the last chunk if that is not full.
        """
        growing = rows - start < self.chunk[0]  # its fletcher32 fails while a writer is rewriting it
        data = self.whole(start, verify=not growing)[: rows - start]
        if growing and isal_zlib.crc32(data) != tail:
            raise ValueError("a checksum does not match")
        return data

    def whole(self, start: int, verify: bool = True) -> np.ndarray:
        """The whole chunk that begins at row `start`, including values beyond the last row.

        At most as many bytes are read as a chunk of this size can have.

        Args:
            start: first row of the chunk.
            verify: whether its checksum has to match.
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
        """Write a whole chunk, after the dataset has grown to its last row, as HDF5 requires.

        Args:
            start: first row of the chunk.
            rows: number of its rows that belong to the dataset.
            data: values of the whole chunk.
            plain: whether it is stored uncompressed in a compressed dataset.
        """
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
        """Set the number of rows."""
        self.id.set_extent((rows, *self.chunk[1:]))
        self.extent = rows
