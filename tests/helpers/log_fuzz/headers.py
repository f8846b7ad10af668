"""Wrong headers: attributes, the commit record, and datasets that are missing or unknown."""

import h5py
import numpy as np
from numpy.random import Generator

from helpers.log_fuzz.editor import Change, Editor, Effect, broken, some
from idealgas.log.hdf5.commit import DATASET

ATTRIBUTES = (
    ("/", "format"), ("/", "format_version"), ("/", "seed"), ("/", "created"), ("versions", "trajectory"),
    ("versions", "numpy"), ("box", "boundary"),
)  # fmt: skip


def attribute(editor: Editor, random: Generator) -> Effect | None:
    """An attribute that is missing or of another type."""
    group, name = some(random, [*ATTRIBUTES])
    values = {
        "missing": None,
        "empty": h5py.Empty("f8"),
        "a list": np.arange(5.0),
        "a text": "what",
        "not UTF-8": np.bytes_(b"\xff\xfe\x1b[31m"),
        "huge": np.uint64(2**64 - 1),
        "nan": np.nan,
        "large": np.zeros(60_000, "u1"),
    }
    way = some(random, [*values])
    attributes = editor.file[group].attrs
    del attributes[name]
    if values[way] is not None:
        attributes.create(name, values[way])
    if name.startswith("format"):
        return broken(f"{way}: {name}:")
    return broken(f"{way}:", "box@boundary") if name == "boundary" else Effect(f"{way}: {name}")


def missing(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, editor.datasets())
    del editor.file[path]
    return broken("missing:", path)


def unlisted(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, editor.paths)
    editor.drop(path)
    return Effect(f"never had {path}")


def added(editor: Editor, random: Generator) -> Effect | None:
    name = some(random, ["events/colour", "discs/charge", "notes", "observables/x/value", "checkpoints/spare"])
    editor.file.require_dataset(name, (9,), "f8")
    return Effect(f"{name} too")


def record(editor: Editor, random: Generator) -> Effect | None:
    """A commit record with other numbers of rows."""
    table = some(random, list(editor.rows))
    path = next((path for path in editor.paths if path.partition("/")[0] == table), None)
    if path is None:
        return None
    if random.random() < 0.3:
        editor.rows[table] = 0
        return Effect(f"no rows of {table}")
    editor.rows[table] = len(editor.file[path]) + 2 ** int(random.integers(0, 63))
    return broken(f"{editor.rows[table]} rows of {table}:", path)


def other_record(editor: Editor, random: Generator) -> Effect | None:
    """A commit record that is missing, or has another type or list of datasets."""
    file, way = editor.file, some(random, ["missing", "type", "no list", "not UTF-8", "unknown path", "twice"])
    values, paths = file[DATASET][...], file[DATASET].attrs["datasets"]
    lists = {"not UTF-8": b"\xff\xff", "unknown path": b"events/nothing", "twice": paths[1]}
    editor.seal = lambda: None  # type: ignore[method-assign]  # the record stays as it is
    if way in lists:
        file[DATASET].attrs["datasets"] = np.array([lists[way], *paths[1:]])
    elif way == "no list":
        del file[DATASET].attrs["datasets"]
    else:
        del file[DATASET]
        if way == "type":
            file[DATASET] = values.astype("f8")
    return broken(f"{way}: {DATASET}")


CHANGES: tuple[Change, ...] = (attribute, attribute, missing, missing, unlisted, added, record, record, other_record)
"""Each is drawn as often as it is listed."""
