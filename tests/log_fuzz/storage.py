"""Changes of how datasets are stored: types, shapes, lengths, layouts, chunks and what they hold."""

import zlib
from functools import cache

import h5py
import numpy as np
from numpy.random import Generator

from idealgas.log.hdf5 import chunks
from log_fuzz.editor import Editor
from log_fuzz.effect import Effect, broken, doubtful, orderly, same
from log_fuzz.values import of_an_effect, some, with_rows

GIB = 2**30


def any_dataset(editor: Editor, random: Generator, kind: str = "fiuS") -> str | None:
    return some(random, [path for path in with_rows(editor, kind, 0) if len(editor.file[path])])


def other_type(editor: Editor, random: Generator) -> Effect | None:
    path = any_dataset(editor, random, "fiu")
    if path is None:
        return None
    values, old = editor.values(path), editor.file[path].dtype
    kinds = ("f4", "f2", "i1", "u8", "i8", ">f8", ">i4", "S3", "f8", "u1", "?", "c16")
    dtype = np.dtype(kinds[random.integers(len(kinds))])
    if dtype == old:
        return None
    with np.errstate(all="ignore"):
        changed = values.astype("S3" if dtype.kind == "S" else dtype)
        back = None if dtype.kind in "Sc" else changed.astype(old)
    editor.remake(path, changed)
    if back is not None and np.array_equal(back, values):
        return doubtful(f"{path} as {dtype.str}")
    if of_an_effect(path) or (path.startswith("observables/") and dtype.str in ("<f8", "<i8")):
        return orderly(f"as {dtype.str}: {path}")  # only a run knows which kind of number it keeps
    return broken(f"as {dtype.str}:", path)


def strange_type(editor: Editor, random: Generator) -> Effect | None:
    """Types that are no numbers: texts of variable length, references, compounds, arrays, opaque bytes."""
    path = any_dataset(editor, random)
    if path is None:
        return None
    rows = editor.length(path)
    types = {
        "text": h5py.string_dtype(),
        "reference": h5py.ref_dtype,
        "region": h5py.regionref_dtype,
        "compound": np.dtype([("a", "f8"), ("b", "i4")]),
        "array": np.dtype(("f8", (3,))),
        "opaque": np.dtype("V16"),
        "ragged": h5py.vlen_dtype(np.dtype("f8")),
    }
    name = list(types)[random.integers(len(types))]
    del editor.file[path]
    made = editor.file.create_dataset(path, (rows,), types[name], chunks=(max(rows, 1),), maxshape=(None,))
    if name == "text" and rows:
        made[...] = "x"
    return broken(f"as {name}:", path)


def other_shape(editor: Editor, random: Generator) -> Effect | None:
    path = any_dataset(editor, random)
    if path is None:
        return None
    values = editor.values(path)
    kind = ("scalar", "more columns", "flat", "one more axis", "empty axis")[random.integers(5)]
    if kind == "flat" and values.ndim == 1:
        kind = "more columns"
    changed = {
        "scalar": lambda: values[:1].reshape(-1)[:1].reshape(()),
        "more columns": lambda: np.repeat(values[..., None] if values.ndim == 1 else values, 3, axis=-1),
        "flat": lambda: values.reshape(-1),
        "one more axis": lambda: values[..., None],
        "empty axis": lambda: values[..., None][..., :0],
    }[kind]()
    options = {"chunks": None, "maxshape": None, "fletcher32": None, "shuffle": None, "compression": None}
    if 0 in changed.shape or not changed.shape:
        editor.remake(path, changed, **options, compression_opts=None)
    else:
        editor.remake(path, changed)
    if of_an_effect(path):
        return orderly(f"{kind}: {path}")  # only a run knows its shape
    return broken(f"{kind}:", path)


def other_length(editor: Editor, random: Generator) -> Effect | None:
    """Fewer rows in a column than the record says, or another number of discs in one array."""
    path = any_dataset(editor, random)
    if path is None:
        return None
    values = editor.values(path)
    if path in editor.paths:
        if len(values) < 2:
            return None
        editor.remake(path, values[: len(values) // 2])
        return broken("half its rows:", path)
    if path in ("discs/species_name", "discs/id"):
        return None
    editor.remake(path, np.concatenate([values, values[-1:]]) if random.random() < 0.5 else values[:-1])
    return broken("one row more or less:", path)


def longer(editor: Editor, random: Generator) -> Effect | None:
    """Rows behind those that count, as a writer leaves them that dies between rows and record."""
    path = some(random, [path for path in editor.paths if editor.length(path)])
    if path is None:
        return None
    extent = (GIB, 2**40, editor.length(path) + 1)[random.integers(3)]
    editor.file[path].resize(extent, axis=0)
    what = f"{path} has room for {extent} rows"
    return doubtful(what) if extent >= GIB else same(what)


def other_layout(editor: Editor, random: Generator) -> Effect | None:
    path = any_dataset(editor, random, "fiu")
    if path is None:
        return None
    values = editor.values(path)
    plain = {"chunks": None, "maxshape": None, "fletcher32": None, "shuffle": None, "compression": None}
    ways = {
        "contiguous": {**plain, "compression_opts": None},
        "chunks of one row": {"chunks": (1, *values.shape[1:])},
        "chunks of 7 rows": {"chunks": (7, *values.shape[1:]), "maxshape": (None, *values.shape[1:])},
        "no check sum": {"fletcher32": None},
        "no shuffle": {"shuffle": None},
        "lzf": {"compression": "lzf", "compression_opts": None},
        "scaled": {"scaleoffset": 0, "fletcher32": None} if values.dtype.kind in "iu" else {"fletcher32": None},
    }
    name = list(ways)[random.integers(len(ways))]
    editor.remake(path, values, **ways[name])
    return doubtful(f"{path} with {name}")


def huge_chunk(editor: Editor, random: Generator) -> Effect | None:
    """A chunk that is declared as large as HDF5 lets it be; nothing, or little, is stored."""
    path = any_dataset(editor, random, "fiu")
    if path is None:
        return None
    values = editor.values(path)
    width = values.dtype.itemsize * int(np.prod(values.shape[1:]))
    rows = (2**32 - 1) // width
    stored = zlib.compress(values.tobytes()) if random.random() < 0.5 else None
    attributes = dict(editor.file[path].attrs)
    del editor.file[path]
    made = editor.file.create_dataset(
        path, values.shape, values.dtype, chunks=(rows, *values.shape[1:]), maxshape=(None, *values.shape[1:]),
        compression="gzip", shuffle=True, fletcher32=True,
    )  # fmt: skip
    made.attrs.update(attributes)
    if stored:
        made.id.write_direct_chunk((0,) * values.ndim, stored, chunks.COMPRESSED)
    return broken("chunks of 4 GiB:", path)


@cache
def bomb(size: int) -> bytes:
    """A zlib stream of as many zeros."""
    block, deflate = 2**20, zlib.compressobj(9, zlib.DEFLATED, -15)
    zeros = deflate.compress(bytes(block)) + deflate.flush(zlib.Z_FULL_FLUSH)
    count = size // block
    check = (count * block % 65_521) << 16 | 1
    return b"\x78\x01" + zeros * count + b"\x03\x00" + check.to_bytes(4, "big")


def decompression_bomb(editor: Editor, random: Generator) -> Effect | None:
    path = any_dataset(editor, random, "fiu")
    if path is None or editor.file[path].compression != "gzip":
        return None
    size = (GIB * 3, GIB // 4)[random.integers(2)]
    try:
        editor.raw(path, bomb(size))
    except OSError:
        return None  # the chunk is declared to be too small for it
    return broken(f"a bomb of {size} bytes in", path)


def wrong_bytes(editor: Editor, random: Generator) -> Effect | None:
    """A chunk that is no stream, too short, too long, or stored otherwise than its mask says."""
    path = any_dataset(editor, random)
    if path is None or editor.file[path].compression != "gzip":
        return None
    length = editor.file[path].dtype.itemsize * int(np.prod(editor.file[path].chunks))
    ways = {
        "noise": (random.bytes(64), chunks.COMPRESSED),
        "nothing": (b"\0", chunks.COMPRESSED),
        "half": (zlib.compress(bytes(length // 2)), chunks.COMPRESSED),
        "one byte more": (zlib.compress(bytes(length) + b"x"), chunks.COMPRESSED),
        "not divisible": (zlib.compress(bytes(max(1, length - 1))), chunks.COMPRESSED),
        "plain, too short": (random.bytes(20), chunks.PLAIN),
        "a mask of all": (random.bytes(40), 0xFFFFFFFF),
        "deflated, says plain": (zlib.compress(bytes(length)), chunks.PLAIN),
        "no filter left out": (zlib.compress(bytes(length)), 0),
    }
    name = list(ways)[random.integers(len(ways))]
    editor.raw(path, *ways[name])
    return broken(f"{name} in", path)


def missing_chunk(editor: Editor, random: Generator) -> Effect | None:
    path = any_dataset(editor, random)
    if path is None:
        return None
    old = editor.file[path]
    shape, dtype, layout, top = old.shape, old.dtype, old.chunks, old.maxshape
    del editor.file[path]
    editor.file.create_dataset(
        path, shape, dtype, chunks=layout, maxshape=top, compression="gzip", shuffle=True, fletcher32=True
    )
    return broken("no chunk in", path)
