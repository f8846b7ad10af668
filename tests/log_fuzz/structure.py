"""Changes of a file's structure: types, shapes, links, layouts, sizes, attributes, and what is missing or too much."""

import os
import zlib
from functools import cache

import h5py
import numpy as np
from numpy.random import Generator

from idealgas.log.hdf5 import chunks
from idealgas.log.hdf5.commit import DATASET
from log_fuzz.editor import Editor
from log_fuzz.effect import Effect, broken, doubtful, orderly, same
from log_fuzz.values import Change, of_an_effect, some, with_rows

GIB = 2**30
OTHER = "other.h5"
"""A file beside the log, which nobody is to open; `PIPE` is a FIFO."""
PIPE = "pipe"


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


def link(editor: Editor, random: Generator) -> Effect | None:
    """Another name, another file, or nothing where a dataset was."""
    path = any_dataset(editor, random)
    if path is None:
        return None
    ways = ("external", "pipe", "soft", "dangling", "cycle", "other dataset", "group", "type", "root")
    name = ways[random.integers(len(ways))]
    file = editor.file
    if name == "soft":
        file.move(path, "elsewhere")
        file[path] = h5py.SoftLink("/elsewhere")
        return doubtful(f"{path} by a soft link")
    if name == "external":
        with h5py.File(editor.path.parent / OTHER, "a") as other:
            if path not in other:
                file.copy(path, other, name=path)
    del file[path]
    if name == "external":
        file[path] = h5py.ExternalLink(OTHER, f"/{path}")
    elif name == "pipe":
        file[path] = h5py.ExternalLink(PIPE, f"/{path}")
    elif name == "dangling":
        file[path] = h5py.SoftLink("/nowhere/at/all")
    elif name == "cycle":
        file[path], file["cycle"] = h5py.SoftLink("/cycle"), h5py.SoftLink(f"/{path}")
    elif name == "other dataset":
        target = some(random, [other for other in ("discs/species_name", "walls/name", "gravity") if other in file])
        file[path] = file[target]
    elif name == "group":
        file.create_group(path)
    elif name == "type":
        file[path] = np.dtype("f8")
    else:
        file[path] = file["/"]
    return broken(f"{name} at", path)


def other_storage(editor: Editor, random: Generator) -> Effect | None:
    """Rows that lie in another file: external storage, or a virtual dataset."""
    path = any_dataset(editor, random, "fiu")
    if path is None:
        return None
    values = editor.values(path)
    del editor.file[path]
    if random.random() < 0.5:
        outer = (editor.path.parent / "raw").resolve()
        outer.write_bytes(np.ascontiguousarray(values).tobytes())
        editor.file.create_dataset(path, values.shape, values.dtype, external=[(str(outer), 0, h5py.h5f.UNLIMITED)])
        return broken("external storage of", path)
    layout = h5py.VirtualLayout(values.shape, values.dtype)
    if values.size:
        layout[...] = h5py.VirtualSource(OTHER, "x", shape=values.shape)
    editor.file.create_virtual_dataset(path, layout)
    return broken("virtual:", path)


def loop(editor: Editor, random: Generator) -> Effect | None:
    """A group within itself."""
    group = some(random, ["events", "discs", "checkpoints", "observables", "h5md"])
    if group not in editor.file:
        return None
    editor.file[f"{group}/loop"] = editor.file["/" if random.random() < 0.5 else group]
    return doubtful(f"{group} has a loop")


def missing(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, editor.datasets())
    if path is None:
        return None
    del editor.file[path]
    return broken("without", path)


def unlisted(editor: Editor, random: Generator) -> Effect | None:
    """A column gone without a trace."""
    path = some(random, editor.paths)
    if path is None:
        return None
    editor.drop(path)
    return orderly(f"never had {path}")


def added(editor: Editor, random: Generator) -> Effect | None:
    """Something that no version has."""
    name = some(random, ["events/colour", "discs/charge", "notes", "observables/x/value", "checkpoints/spare"])
    assert name is not None
    if name in editor.file:
        return None
    editor.file[name] = random.normal(size=random.integers(1, 99))
    return same(f"{name} too")


def attribute(editor: Editor, random: Generator) -> Effect | None:
    """An attribute of the file or a group: gone, of another type, or too much."""
    group, name = [
        ("/", "format"), ("/", "format_version"), ("/", "seed"), ("/", "created"), ("versions", "trajectory"),
        ("versions", "numpy"), ("box", "boundary"), ("box", "boundary"),
    ][random.integers(8)]  # fmt: skip
    attributes = editor.file[group].attrs
    if name not in attributes:
        return None
    values = {
        "gone": None,
        "empty": h5py.Empty("f8"),
        "a list": np.arange(5.0),
        "a text": "what",
        "wrong UTF-8": np.bytes_(b"\xff\xfe\x1b[31m"),
        "huge": np.uint64(2**64 - 1),
        "minus": np.int64(-1),
        "nan": np.nan,
        "a reference": editor.file["/"].ref,
        "large": np.zeros(60_000, "u1"),
    }
    way = list(values)[random.integers(len(values))]
    del attributes[name]
    if values[way] is not None:
        attributes.create(name, values[way])
    if name == "format" or (name == "format_version" and way in ("gone", "empty", "a list", "a text", "huge")):
        return broken(f"{group} {name} {way}")
    return broken(f"{way} in", "box@boundary") if name == "boundary" else orderly(f"{group} {name} {way}")


def more_attributes(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, [*editor.datasets(), "events", "discs", "/"])
    if path is None or path not in editor.file:
        return None
    attributes = editor.file[path].attrs
    way = int(random.integers(4))
    if way == 0:
        attributes["unit"] = "\x1b[31mfurlongs"
    elif way == 1:
        for number in range(40):  # so many lie in a heap
            attributes[f"note{number}"] = number
    elif way == 2:
        attributes["note"] = np.array(["a", "b"], h5py.string_dtype())
    elif "unit" in attributes:
        del attributes["unit"]
    if path in ("/", "versions"):
        return orderly("another attribute of /")
    return same(f"other attributes of {path}")


def record(editor: Editor, random: Generator) -> Effect | None:
    """A commit record that promises what is not there."""
    table = some(random, list(editor.rows))
    assert table is not None
    way = ("too many", "far too many", "none", "fewer", "tail", "size", "sequence")[random.integers(7)]
    path = next(path for path in editor.paths if path.partition("/")[0] == table)
    if way in ("too many", "far too many"):
        editor.rows[table] += 1 if way == "too many" else 2 ** int(random.integers(20, 63))
        return broken(f"{way} rows of {table}:", path)
    if way == "none":
        editor.rows[table] = 0
        return orderly(f"no rows of {table}")
    if way == "fewer":
        editor.rows[table] //= 2
        return broken(f"half the rows of {table}, check sums of all:", path) if editor.rows[table] else orderly("none")
    if way == "tail":
        path = some(random, [path for path in editor.paths if editor.tails[path]]) or path
        if not editor.tails[path]:
            return None
        editor.tails[path] ^= 1 << int(random.integers(63))
        return broken("a check sum of", path)
    if way == "size":
        editor.size = (0, 2**63, editor.path.stat().st_size * 2)[random.integers(3)]
        return doubtful("another size of the file on record")
    editor.sequence = 2**63
    return same("a late sequence number")


def other_record(editor: Editor, random: Generator) -> Effect | None:
    """A commit dataset that is none."""
    way = ("gone", "type", "one slot", "no list", "not UTF-8", "unknown path", "twice", "long list", "upwards", "link")
    name = way[random.integers(len(way))]
    file = editor.file
    editor.seal()
    record = file[DATASET]
    paths = record.attrs["datasets"]
    lists = {
        "not UTF-8": [b"\xff\xff", *paths[1:]],
        "unknown path": [b"events/nothing", *paths[1:]],
        "twice": [paths[1], *paths[1:]],
        "long list": [*paths, *[b"events/x%d" % number for number in range(500)]],
        "upwards": [b"../../etc/passwd", *paths[1:]],
    }
    if name == "no list":
        del record.attrs["datasets"]
    elif name in lists:
        record.attrs["datasets"] = np.array(lists[name])
    else:
        values = record[...] if name != "gone" else None
        del file[DATASET]
        if name == "type":
            file[DATASET] = values.astype("f8")
        elif name == "one slot":
            file.create_dataset(DATASET, data=values[:1], chunks=values[:1].shape, fletcher32=True)
        elif name == "link":
            file[DATASET] = h5py.ExternalLink(PIPE, "/commit")
    return broken(f"{name}: {DATASET}")


def special_file(editor: Editor, random: Generator) -> Effect | None:
    """Not a file at all: a pipe, a device, a folder, a link to itself."""
    editor.leave_unsealed()
    editor.file.close()
    way = ("pipe", "device", "folder", "loop", "nothing")[random.integers(5)]
    editor.path.unlink()
    if way == "pipe":
        os.mkfifo(editor.path)
    elif way == "device":
        editor.path.symlink_to("/dev/zero")
    elif way == "folder":
        editor.path.mkdir()
    elif way == "loop":
        editor.path.symlink_to(editor.path.name)
    return broken(f"a {way} instead of a file")


CHANGES: tuple[Change, ...] = (
    other_type,
    other_type,
    strange_type,
    other_shape,
    other_shape,
    other_length,
    longer,
    other_layout,
    huge_chunk,
    decompression_bomb,
    wrong_bytes,
    wrong_bytes,
    missing_chunk,
    link,
    link,
    link,
    other_storage,
    loop,
    missing,
    missing,
    unlisted,
    added,
    attribute,
    attribute,
    more_attributes,
    record,
    record,
    other_record,
)
"""Each is drawn as often as it stands here; `special_file` ends a log, so it is drawn alone."""
