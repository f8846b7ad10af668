"""Read and write a dataset of a log in whole chunks, bypassing HDF5's own filters and cache."""

import math

import h5py
import numpy as np
from h5py import h5z
from isal import isal_zlib

from idealgas.log.hdf5 import chunks

NUMBERS = ("<f8", "<i8", "<u8", "<i4", "<u4", "<u2", "|u1")
"""NumPy types that the numbers in a log may have."""

_COMPRESSED = (h5z.FILTER_SHUFFLE, h5z.FILTER_DEFLATE, h5z.FILTER_FLETCHER32)
_PLAIN = (h5z.FILTER_FLETCHER32,)


class StoredColumn:
    """A dataset that is divided into chunks only along its first axis.

    Attributes:
        dtype: type of the values.
        shape: shape of the dataset when it was opened.
        chunk: shape of a chunk.
        extent: current number of rows.
    """

    def __init__(self, file: h5py.File, path: str, encoder: chunks.Encoder | None = None) -> None:
        """Open a dataset. Raises KeyError if it is missing, and ValueError if a log cannot contain such a dataset."""
        try:
            dataset = h5py.h5o.open(file.id, path.encode())  # h5py's Dataset takes four times as long to open
        except KeyError:
            if path not in file:
                raise KeyError("missing") from None
            raise
        if not isinstance(dataset, h5py.h5d.DatasetID):
            raise ValueError("not a dataset")
        stored = dataset.get_create_plist()
        if stored.get_layout() != h5py.h5d.CHUNKED:
            raise ValueError("not in chunks")
        pipeline = tuple(stored.get_filter(k)[0] for k in range(stored.get_nfilters()))
        if pipeline not in (_COMPRESSED, _PLAIN):
            raise ValueError(f"filters {', '.join(map(str, pipeline)) or 'none'} (allowed: {_COMPRESSED} or {_PLAIN})")
        self.id, self.dtype, self.shape, self.chunk = dataset, dataset.dtype, dataset.shape, stored.get_chunk()
        if self.dtype.kind != "S" and self.dtype.str not in NUMBERS:
            raise ValueError(f"unsupported type (allowed: {', '.join(NUMBERS)} and text of fixed length)")
        if self.shape[1:] != self.chunk[1:]:
            raise ValueError(f"in chunks of shape {self.chunk} (got an extent of {self.shape})")
        self._encoder = encoder or chunks.Encoder()
        self.extent: int = self.shape[0]  # kept here because asking HDF5 would slow down writing
        self._compressed = pipeline == _COMPRESSED
        self._origin = (0,) * (len(self.chunk) - 1)

    def read(self, start: int, rows: int, tail: int = 0) -> np.ndarray:
        """Return the committed rows of the chunk that begins at row `start`.

        A damaged or missing chunk raises an error of NumPy or HDF5.

        Args:
            start: first row of the chunk.
            rows: number of committed rows of the dataset.
            tail: CRC-32 of the committed rows in the last chunk if this chunk is not full.
        """
        growing = rows - start < self.chunk[0]  # a growing chunk fails its fletcher32 while a writer rewrites it
        data = self.whole(start, verify=not growing)[: rows - start]
        if growing and isal_zlib.crc32(data) != tail:
            raise ValueError("a checksum does not match")
        return data

    def whole(self, start: int, verify: bool = True) -> np.ndarray:
        """Return the whole chunk that begins at row `start`, including values beyond the last row.

        Args:
            start: first row of the chunk.
            verify: whether the checksum of the chunk has to match.
        """
        mask, stored = self.id.read_direct_chunk((start, *self._origin))
        if not self._compressed:  # the pipeline is only the checksum, so the bits of its masks differ
            mask = chunks.PLAIN
        return chunks.decode(stored, mask, self.dtype, math.prod(self.chunk), verify).reshape(self.chunk)

    def write(self, start: int, rows: int, data: np.ndarray, plain: bool = False) -> None:
        """Write a whole chunk. If necessary, the dataset is extended first, as HDF5 requires.

        Args:
            start: first row of the chunk.
            rows: number of rows of the chunk that belong to the dataset.
            data: values of the whole chunk.
            plain: whether to store the chunk uncompressed in a compressed dataset.
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
