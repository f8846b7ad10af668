"""Groups, datasets and attributes of a new file, created through HDF5's C interface.

h5py's high-level interface takes five times as long, which is noticeable for a short log of about fifty datasets.
"""

from functools import cache, lru_cache
from typing import Any

import h5py
import numpy as np
from h5py import h5a, h5d, h5f, h5g, h5p, h5s, h5t

from idealgas.log.hdf5 import chunks
from idealgas.log.hdf5.safe_hdf5 import check_chunk


class Objects:
    """Creates the objects of a file and their parent groups. Paths have no leading slash."""

    def __init__(self, file: h5f.FileID, compression: str = "none") -> None:
        """Begin with an empty file. compression: "gzip" (with shuffle) or "none"; all datasets have checksums."""
        self._groups: dict[str, Any] = {"": file}
        self._compressed = compression == "gzip"

    def group(self, path: str) -> h5g.GroupID:
        """Group at a path, created if it is missing."""
        if path not in self._groups:
            above, _, name = path.rpartition("/")
            self._groups[path] = h5g.create(self.group(above), name.encode(), gcpl=_group_layout())
        return self._groups[path]

    def column(self, path: str, dtype: Any, chunk: tuple[int, ...], unit: str = "") -> None:
        """Create an empty dataset that grows along its first axis. chunk: shape of a chunk."""
        self._dataset(path, dtype, (0, *chunk[1:]), chunk, unit)

    def constant(self, path: str, data: np.ndarray, unit: str = "") -> h5d.DatasetID:
        """A dataset that never changes, in one chunk, as contiguous datasets have no checksums."""
        if not data.size:
            above, _, name = path.rpartition("/")
            return h5py.Group(self.group(above)).create_dataset(name, data=data).id
        dataset = self._dataset(path, data.dtype, data.shape, data.shape, unit, growing=False)
        encoder, start = chunks.Encoder(), (0,) * data.ndim
        if self._compressed:
            dataset.write_direct_chunk(start, encoder.compressed(data), chunks.COMPRESSED)
        else:
            dataset.write_direct_chunk(start, encoder.plain(data))
        return dataset

    def link(self, path: str, target: str) -> None:
        """A second name for the object at `target`."""
        above, _, name = path.rpartition("/")
        self.group(above).links.create_hard(name.encode(), self._groups[""], target.encode())

    def _dataset(
        self, path: str, dtype: Any, shape: tuple[int, ...], chunk: tuple[int, ...], unit: str, growing: bool = True
    ) -> h5d.DatasetID:
        above, _, name = path.rpartition("/")
        space = h5s.create_simple(shape, (h5s.UNLIMITED if growing else shape[0], *shape[1:]))
        kind = h5t.py_create(np.dtype(dtype), logical=True)
        try:
            check_chunk(chunk, np.dtype(dtype))
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from error
        dataset = h5d.create(self.group(above), name.encode(), kind, space, _dataset_layout(chunk, self._compressed))
        if unit:
            set_attributes(dataset, unit=np.bytes_(unit))
        return dataset


def set_attributes(thing: Any, **values: Any) -> None:
    """Create attributes of a group, dataset or file (h5py.h5g.GroupID and so on)."""
    for name, value in values.items():
        data = np.asarray(value)
        kind, space = h5t.py_create(data.dtype, logical=True), h5s.create_simple(data.shape)
        h5a.create(thing, name.encode(), kind, space).write(data)


@cache
def _group_layout() -> h5p.PropGCID:
    layout = h5p.create(h5p.GROUP_CREATE)
    layout.set_obj_track_times(False)
    return layout


@lru_cache
def _dataset_layout(chunk: tuple[int, ...], compressed: bool) -> h5p.PropDCID:
    layout = h5p.create(h5p.DATASET_CREATE)
    layout.set_obj_track_times(False)
    layout.set_chunk(chunk)
    if compressed:
        layout.set_shuffle()
        layout.set_deflate(1)
    layout.set_fletcher32()
    return layout
