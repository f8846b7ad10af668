"""Safe access to an HDF5 file of unknown origin: only objects that a log has are opened, up to a bounded size.

A log has groups, chunked datasets with one of two filter pipelines, and attributes. They contain numbers or text of
fixed length, and are stored in the file itself. Everything else is refused before HDF5 follows or allocates it: soft
and external links, external storage, virtual datasets, references, text of variable length, other filters. Refused
objects raise ValueError, missing ones KeyError.
"""

import math
from functools import cache
from typing import Any, NamedTuple

import h5py
import numpy as np
from h5py import h5a, h5d, h5g, h5l, h5o, h5t, h5z

MOST_CHUNK = 2**28
"""Largest size of a chunk, and so of an array that is stored before a run, bytes."""

MOST_TEXT = 2**24
"""Largest size of a text in a row, bytes."""

MOST_ATTRIBUTE = 2**16
"""Largest size of an attribute, bytes."""

NUMBERS = ("<f8", "<i8", "<u8", "<i4", "<u4", "<u2", "|u1")
"""NumPy types of all numbers in a log."""

_COMPRESSED = (h5z.FILTER_SHUFFLE, h5z.FILTER_DEFLATE, h5z.FILTER_FLETCHER32)
_PLAIN = (h5z.FILTER_FLETCHER32,)

_LINKS = {h5l.TYPE_SOFT: "a soft link", h5l.TYPE_EXTERNAL: "an external link"}
_LAYOUTS = {h5d.VIRTUAL: "a virtual dataset", h5d.CONTIGUOUS: "not in chunks", h5d.COMPACT: "not in chunks"}


class Layout(NamedTuple):
    """Storage layout of a dataset.

    Attributes:
        dtype: type of its numbers or text.
        shape: shape of the dataset.
        chunk: shape of a chunk.
        compressed: whether chunks are shuffled and deflated.
    """

    dtype: np.dtype
    shape: tuple[int, ...]
    chunk: tuple[int, ...]
    compressed: bool


def open_object(file: h5py.File, path: str) -> Any:
    """Group or dataset at a path (h5py.h5g.GroupID, h5py.h5d.DatasetID)."""
    found = h5g.open(file.id, b"/")
    for name in filter(None, path.split("/")):
        if not isinstance(found, h5g.GroupID):
            raise ValueError("parent is not a group")
        if not found.links.exists(name.encode()):
            raise KeyError("missing")
        link = found.links.get_info(name.encode())
        if link.type != h5l.TYPE_HARD:
            raise ValueError(f"{_LINKS.get(link.type, 'a link')} (allowed: hard links)")
        found = h5o.open(found, name.encode())
    return found


def open_dataset(file: h5py.File, path: str) -> h5d.DatasetID:
    """Dataset at a path."""
    found = open_object(file, path)
    if not isinstance(found, h5d.DatasetID):
        raise ValueError("not a dataset")
    return found


def layout_of(dataset: h5d.DatasetID) -> Layout:
    """Layout of a dataset, from its creation properties alone."""
    stored = dataset.get_create_plist()
    if (kind := stored.get_layout()) != h5d.CHUNKED:
        raise ValueError(_LAYOUTS.get(kind, "unknown storage layout"))
    pipeline = tuple(stored.get_filter(k)[0] for k in range(stored.get_nfilters()))
    if pipeline not in (_COMPRESSED, _PLAIN):
        raise ValueError(f"filters {', '.join(map(str, pipeline)) or 'none'} (allowed: {_COMPRESSED} or {_PLAIN})")
    dtype, shape, chunk = _dtype(dataset.get_type()), dataset.shape, stored.get_chunk()
    if shape is None or len(shape) != len(chunk) or shape[1:] != chunk[1:]:
        raise ValueError(f"in chunks of shape {chunk} (got an extent of {shape})")
    check_chunk(chunk, dtype)
    return Layout(dtype, shape, chunk, pipeline == _COMPRESSED)


def check_chunk(chunk: tuple[int, ...], dtype: np.dtype) -> None:
    """Raise ValueError for chunks that need too much memory, and for texts that are too long."""
    if (size := math.prod(chunk) * dtype.itemsize) > MOST_CHUNK:
        raise ValueError(f"a chunk of {size:,} bytes (allowed up to {MOST_CHUNK:,})")
    if dtype.kind == "S" and dtype.itemsize > MOST_TEXT:
        raise ValueError(f"text of {dtype.itemsize:,} bytes (allowed up to {MOST_TEXT:,})")


def attribute(thing: Any, name: str) -> np.ndarray:
    """Attribute of a group or dataset. Raises KeyError if it is missing."""
    if not h5a.exists(thing, name.encode()):
        raise KeyError(f"attribute {name}: missing")
    found = h5a.open(thing, name.encode())
    dtype, shape = _dtype(found.get_type()), found.shape
    if shape is None or math.prod(shape) * dtype.itemsize > MOST_ATTRIBUTE:
        raise ValueError(f"attribute {name}: too large (allowed up to {MOST_ATTRIBUTE:,} bytes)")
    value = np.empty(shape, dtype)
    found.read(value)
    return value


def value(thing: Any, name: str) -> str | int:
    """Attribute that is a single text or integer."""
    found = attribute(thing, name)
    if found.ndim or found.dtype.kind == "f":
        raise ValueError(f"attribute {name}: not a single text or integer")
    try:
        return found.item().decode() if found.dtype.kind == "S" else found.item()
    except UnicodeDecodeError as error:
        raise ValueError(f"attribute {name}: not UTF-8 text") from error


def _dtype(kind: h5t.TypeID) -> np.dtype:
    """NumPy type of numbers, or of text of fixed length."""
    if kind.get_class() == h5t.STRING:
        if kind.is_variable_str():
            raise ValueError("text of variable length")
        return np.dtype(f"S{kind.get_size()}")
    base = kind.get_super() if kind.get_class() == h5t.ENUM else kind
    for name, number in _numbers().items():
        if base.equal(number):
            return np.dtype(name)
    raise ValueError(f"unsupported type (allowed: {', '.join(NUMBERS)} and text of fixed length)")


@cache
def _numbers() -> dict[str, h5t.TypeID]:
    return {name: h5t.py_create(np.dtype(name)) for name in NUMBERS}
