"""Changes of a file's structure: links, attributes, the record, and what is missing or too much."""

import os

import h5py
import numpy as np
from numpy.random import Generator

from idealgas.log.hdf5.commit import DATASET
from log_fuzz import storage
from log_fuzz.editor import Editor
from log_fuzz.effect import Effect, broken, doubtful, orderly, same
from log_fuzz.storage import any_dataset
from log_fuzz.values import Change, some

OTHER = "other.h5"
"""A file beside the log, which nobody is to open; `PIPE` is a FIFO."""
PIPE = "pipe"


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
    storage.other_type,
    storage.other_type,
    storage.strange_type,
    storage.other_shape,
    storage.other_shape,
    storage.other_length,
    storage.longer,
    storage.other_layout,
    storage.huge_chunk,
    storage.decompression_bomb,
    storage.wrong_bytes,
    storage.wrong_bytes,
    storage.missing_chunk,
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
