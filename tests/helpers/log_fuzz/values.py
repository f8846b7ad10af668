"""Wrong numbers: not finite, out of range, out of order, of another type or shape; and unusual ones."""

import numpy as np
from numpy.random import Generator

from helpers.log_fuzz.editor import Change, Editor, Effect, broken, some
from idealgas.columns import EVENT_COLUMNS, Kind
from idealgas.log.schema import CHECKPOINT_COLUMNS

NOT_FINITE = (np.nan, np.inf, -np.inf)
STRANGE = (5e-324, -5e-324, 1e-310, 1e-200, -0.0, 1e154, -1e154, 1e300, -1.7e308)
"""Finite floats at the edge of arithmetic."""
ORDERED = ("events/time", "checkpoints/time", "checkpoints/row")


def of_an_effect(path: str) -> bool:
    """Whether only a run knows the type and range of a column of checkpoints."""
    table, _, name = path.partition("/")
    return table == "checkpoints" and name not in [column.name for column in (*CHECKPOINT_COLUMNS, *EVENT_COLUMNS)]


def row_in(editor: Editor, path: str, random: Generator) -> int:
    """A row but the last, which may be half a collision and then does not count."""
    return int(random.integers(max(1, editor.length(path) - 1)))


def put(editor: Editor, path: str, value: float, random: Generator) -> None:
    """One number, or now and then a whole row of them."""
    values, row = editor.values(path), row_in(editor, path, random)
    entry = values[row : row + 1].reshape(-1)
    entry[slice(None) if random.random() < 0.3 else random.integers(entry.size)] = value
    values[row : row + 1] = entry.reshape(values[row : row + 1].shape)
    editor.store(path, values)


def not_finite(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, [path for path in editor.with_rows("f") if np.isfinite(editor.values(path)).all()])
    value = some(random, [*NOT_FINITE])
    put(editor, path, value, random)
    if of_an_effect(path) and np.isinf(value):
        return Effect(f"{value} in {path}")  # the time of something that has never happened
    return broken(f"{value} in", path)


def strange(editor: Editor, random: Generator) -> Effect | None:
    path, value = some(random, editor.with_rows("f")), some(random, [*STRANGE])
    if random.random() < 0.7:
        put(editor, path, value, random)
    else:
        editor.store(path, np.full_like(editor.values(path), value))
    return Effect(f"{value} in {path}")


def scaled(editor: Editor, random: Generator) -> Effect | None:
    path, factor = some(random, editor.with_rows("f")), 2.0 ** int(random.choice([-1000, -60, -1, 1, 60, 900]))
    with np.errstate(over="ignore"):
        values = editor.values(path) * factor
    if not np.isfinite(values).all():
        return None
    editor.store(path, values)
    return Effect(f"{path} times {factor:g}")


def any_integer(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, editor.with_rows("iu"))
    bounds = np.iinfo(editor.file[path].dtype)
    value = some(random, [bounds.min, bounds.max, bounds.max // 2, 0, 1, bounds.max - 1])
    put(editor, path, value, random)
    return Effect(f"{value} in {path}")


def shuffled_rows(editor: Editor, random: Generator) -> Effect | None:
    paths = [path for path in editor.with_rows("fiu", 2) if not path.endswith(("time", "row", "epoch"))]
    path = some(random, paths)
    editor.store(path, random.permutation(editor.values(path)))
    return Effect(f"{path} in another order")


def unknown_number(editor: Editor, random: Generator) -> Effect | None:
    """A disc, partner, kind or species that does not exist."""
    discs, walls, species = (len(editor.file[path]) for path in ("discs/mass", "walls/name", "discs/species_name"))
    wrong = {
        "events/disc": [discs, 65_536, 2**31, 2**32 - 1],
        "events/partner": [discs, 65_536, 2**31 - 1, -1 - walls, -1000, -(2**31)],
        "events/kind": [len(Kind), 127, 128, 255],
        "discs/species": [species, 65_535],
    }
    path = some(random, [path for path in wrong if path in editor.file and editor.length(path) > 1])
    value = some(random, wrong[path])
    put(editor, path, value, random)
    return broken(f"{value} in", path)


def wrong_pair(editor: Editor, random: Generator) -> Effect | None:
    """A disc that collides with itself, or a kind that is not that of the partner."""
    if not editor.rows.get("events", 0) > 1:
        return None
    kind, partner, disc = (editor.values(f"events/{name}") for name in ("kind", "partner", "disc"))
    row = row_in(editor, "events/partner", random)
    if random.random() < 0.5:
        partner[row] = disc[row]
        editor.store("events/partner", partner)
        return broken("a collision with itself", "events/disc", "events/partner", "events/kind")
    kind[row] = Kind.DISC if partner[row] < 0 else random.choice([kind for kind in Kind if kind != Kind.DISC])
    editor.store("events/kind", kind)
    return broken("a kind that is not its partner's", "events/kind", "events/partner")


def not_positive(editor: Editor, random: Generator) -> Effect | None:
    path, value = some(random, ["discs/radius", "discs/mass", "box"]), some(random, [0.0, -1.0, -1e300, -5e-324])
    put(editor, path, value, random)
    return broken(f"{value} in", path)


def outside(editor: Editor, random: Generator) -> Effect | None:
    if "events/position" not in editor.paths or editor.length("events/position") < 2:
        return None
    size = float(editor.values("box").max())
    value = some(random, [-0.5 * size, 2 * size, -1e9, 1e300])
    put(editor, "events/position", value, random)
    return broken(f"{value} in", "events/position")


def out_of_order(editor: Editor, random: Generator) -> Effect | None:
    samples = [path for path in editor.paths if path.startswith(("observables", "particles")) and path.endswith("time")]
    paths = [path for path in (*ORDERED, *samples) if path in editor.paths and editor.length(path) > 2]
    path = some(random, [path for path in paths if np.unique(editor.values(path)).size > 2])
    if path is None:
        return None
    values = editor.values(path)
    if random.random() < 0.5:
        values = values[::-1].copy()
    else:
        values[0] = -1 if random.random() < 0.5 else -(2**62)
    editor.store(path, values)
    return broken("decreases or begins below 0:", path)


def other_type(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, [path for path in editor.with_rows("fiu") if len(editor.file[path])])
    dtype = np.dtype(some(random, ["f4", "i1", "u8", "i8", ">f8", ">i4", "S3", "f8", "u1", "?", "c16"]))
    if dtype == editor.file[path].dtype:
        return None
    with np.errstate(all="ignore"):
        editor.remake(path, editor.values(path).astype(dtype))
    if of_an_effect(path) or (path.startswith("observables/") and dtype.str in ("<f8", "<i8")):
        return Effect(f"as {dtype.str}: {path}")
    return broken(f"as {dtype.str}:", path)


def other_shape(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, [path for path in editor.with_rows("fiu") if len(editor.file[path])])
    values = editor.values(path)
    ways = {
        "more columns": np.repeat(values[..., None] if values.ndim == 1 else values, 3, axis=-1),
        "one more axis": values[..., None],
        "half its rows": values[: len(values) // 2],
    }
    way = some(random, [way for way in ways if ways[way].size and not (way == "half its rows" and len(values) < 2)])
    editor.remake(path, ways[way])
    return Effect(f"{way}: {path}") if of_an_effect(path) and way != "half its rows" else broken(f"{way}:", path)


CHANGES: tuple[Change, ...] = (
    not_finite, not_finite, strange, strange, scaled, any_integer, any_integer, shuffled_rows, unknown_number,
    unknown_number, wrong_pair, not_positive, outside, out_of_order, other_type, other_shape,
)  # fmt: skip
"""Each is drawn as often as it is listed."""
