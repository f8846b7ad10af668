"""A dataset of a log, read and written in whole chunks, without HDF5's own filters and cache."""

import math

import h5py
import numpy as np
from h5py import h5z
from isal import isal_zlib

from idealgas.log.hdf5 import chunks

NUMBERS = ("<f8", "<i8", "<u8", "<i4", "<u4", "<u2", "|u1")
"""NumPy types of all numbers in a log."""

_COMPRESSED = (h5z.FILTER_SHUFFLE, h5z.FILTER_DEFLATE, h5z.FILTER_FLETCHER32)
_PLAIN = (h5z.FILTER_FLETCHER32,)


class StoredColumn:
    """A dataset whose chunks divide only its first axis.

    Attributes:
        dtype: type of its values.
        shape: shape of the dataset when it was opened.
        chunk: shape of a chunk.
        extent: number of rows.
    """

    def __init__(self, file: h5py.File, path: str, encoder: chunks.Encoder | None = None) -> None:
        """Open a dataset. Raises KeyError if it is missing, ValueError for a layout that no log has."""
        if path not in file:
            raise KeyError("missing")
        dataset = file[path]
        if not isinstance(dataset, h5py.Dataset):
            raise ValueError("not a dataset")
        stored = dataset.id.get_create_plist()
        if stored.get_layout() != h5py.h5d.CHUNKED:
            raise ValueError("not in chunks")
        pipeline = tuple(stored.get_filter(k)[0] for k in range(stored.get_nfilters()))
        if pipeline not in (_COMPRESSED, _PLAIN):
            raise ValueError(f"filters {', '.join(map(str, pipeline)) or 'none'} (allowed: {_COMPRESSED} or {_PLAIN})")
        self.id, self.dtype, self.shape, self.chunk = dataset.id, dataset.dtype, dataset.shape, dataset.chunks
        if self.dtype.kind != "S" and self.dtype.str not in NUMBERS:
            raise ValueError(f"unsupported type (allowed: {', '.join(NUMBERS)} and text of fixed length)")
        if self.shape[1:] != self.chunk[1:]:
            raise ValueError(f"in chunks of shape {self.chunk} (got an extent of {self.shape})")
        self._encoder = encoder or chunks.Encoder()
        self.extent: int = self.shape[0]  # asking HDF5 each time takes as long as storing some planes
        self._compressed = pipeline == _COMPRESSED
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

        verify: whether its checksum has to match.
        """
        mask, stored = self.id.read_direct_chunk((start, *self._origin))
        if not self._compressed:  # bit 0 of its pipeline is the checksum's
            mask = chunks.PLAIN
        return chunks.decode(stored, mask, self.dtype, math.prod(self.chunk), verify).reshape(self.chunk)

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
        data = np.asarray(data, self.dtype)
        if self._compressed and not plain:
            stored, mask = self._encoder.compressed(data), chunks.COMPRESSED
        else:
            stored, mask = self._encoder.plain(data), chunks.PLAIN if self._compressed else 0
        self.id.write_direct_chunk((start, *self._origin), stored, mask)

    def resize(self, rows: int) -> None:
        """Set the number of rows."""
        self.id.set_extent((rows, *self.chunk[1:]))
        self.extent = rows
