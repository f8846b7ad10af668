"""Changes of numbers: what is not finite, out of range or out of order, and what is only strange.

A change takes an `Editor` and random numbers, and returns its `Effect`, or None where the log has nothing for it.
"""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from idealgas.events import EVENT_COLUMNS, Kind
from idealgas.log.schema import CHECKPOINT_COLUMNS, SAMPLE_COLUMNS
from log_fuzz.editor import Editor
from log_fuzz.effect import Effect, broken, orderly

Change = Callable[[Editor, Generator], Effect | None]

NOT_FINITE = (np.nan, np.inf, -np.inf)
STRANGE = (5e-324, -5e-324, 1e-310, 1e-200, -0.0, 1e154, -1e154, 1e300, -1.7e308)
"""Finite floats at the edge of arithmetic."""

EVENT_TIME = f"events/{EVENT_COLUMNS[0].name}"
CHECKPOINT_TIME, CHECKPOINT_ROW, CHECKPOINT_EPOCH = (f"checkpoints/{column.name}" for column in CHECKPOINT_COLUMNS)


def of_an_effect(path: str) -> bool:
    """Whether a column of checkpoints is known to runs alone."""
    table, _, name = path.partition("/")
    return table == "checkpoints" and name not in [column.name for column in (*CHECKPOINT_COLUMNS, *EVENT_COLUMNS)]


def some(random: Generator, items: list[str]) -> str | None:
    """One of the items, or None of none."""
    return items[random.integers(len(items))] if items else None


def with_rows(editor: Editor, kind: str, least: int = 1) -> list[str]:
    """Datasets of a kind of number that have so many rows."""
    found = []
    for path in editor.datasets():
        dataset = editor.file[path]
        if dataset.dtype.kind in kind and dataset.ndim and dataset.chunks and editor.length(path) >= least:
            found.append(path)
    return found


def row_in(editor: Editor, path: str, random: Generator) -> int:
    """A row of a dataset; not the last one of several, which may be half a collision and then does not count."""
    return int(random.integers(max(1, editor.length(path) - 1)))


def put(editor: Editor, path: str, row: int, value: float, random: Generator) -> None:
    """One number in a row, or now and then the whole row."""
    values = editor.values(path)
    entry = values[row : row + 1].reshape(-1)
    if random.random() < 0.3:
        entry[:] = value
    else:
        entry[random.integers(entry.size)] = value
    values[row : row + 1] = entry.reshape(values[row : row + 1].shape)
    editor.store(path, values)


def not_finite(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, [path for path in with_rows(editor, "f") if np.isfinite(editor.values(path)).all()])
    if path is None:
        return None
    value = NOT_FINITE[random.integers(3)]
    put(editor, path, row_in(editor, path, random), value, random)
    if of_an_effect(path) and np.isinf(value):
        return orderly(f"{value} in {path}")  # the time of what has never been
    return broken(f"{value} in", path)


def strange(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, with_rows(editor, "f"))
    if path is None:
        return None
    value = STRANGE[random.integers(len(STRANGE))]
    put(editor, path, row_in(editor, path, random), value, random)
    return orderly(f"{value} in {path}")


def all_strange(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, with_rows(editor, "f"))
    if path is None:
        return None
    value = STRANGE[random.integers(len(STRANGE))]
    editor.store(path, np.full_like(editor.values(path), value))
    return orderly(f"{path} all {value}")


def scaled(editor: Editor, random: Generator) -> Effect | None:
    """The whole of a dataset in other units: nothing is out of place by itself."""
    path = some(random, with_rows(editor, "f"))
    if path is None:
        return None
    factor = 2.0 ** int(random.choice([-1000, -60, -1, 1, 60, 900]))
    with np.errstate(over="ignore"):
        values = editor.values(path) * factor
    if not np.isfinite(values).all():
        return None
    editor.store(path, values)
    return orderly(f"{path} times {factor:g}")


def any_integer(editor: Editor, random: Generator) -> Effect | None:
    """A whole number from one end of its type to the other."""
    path = some(random, with_rows(editor, "iu"))
    if path is None:
        return None
    dtype = editor.file[path].dtype
    bounds = np.iinfo(dtype)
    value = (bounds.min, bounds.max, bounds.max // 2, 0, 1, bounds.max - 1)[random.integers(6)]
    values = editor.values(path)
    row = row_in(editor, path, random)
    values[row : row + 1] = value
    editor.store(path, values)
    return orderly(f"{value} in {path}")


def _event(editor: Editor, name: str, value: int, random: Generator) -> str | None:
    path = f"events/{name}"
    if path not in editor.paths or editor.length(path) < 2:
        return None
    values = editor.values(path)
    values[row_in(editor, path, random)] = value
    editor.store(path, values)
    return path


def unknown_disc(editor: Editor, random: Generator) -> Effect | None:
    number = len(editor.file["discs/mass"])
    value = (number, number + 1, 65_536, 2**31 - 1, 2**31, 4_000_000_000, 2**32 - 1)[random.integers(7)]
    path = _event(editor, "disc", value, random)
    return path and broken(f"{value} in", path)  # type: ignore[return-value]


def unknown_partner(editor: Editor, random: Generator) -> Effect | None:
    number, walls = len(editor.file["discs/mass"]), len(editor.file["walls/name"])
    value = (number, 65_536, 2**31 - 1, -1 - walls, -1000, -(2**31), -2_000_000_000)[random.integers(7)]
    path = _event(editor, "partner", value, random)
    return path and broken(f"{value} in", path)  # type: ignore[return-value]


def unknown_kind(editor: Editor, random: Generator) -> Effect | None:
    value = (len(Kind), 17, 127, 128, 255)[random.integers(5)]
    path = _event(editor, "kind", value, random)
    return path and broken(f"{value} in", path)  # type: ignore[return-value]


def partner_itself(editor: Editor, random: Generator) -> Effect | None:
    if "events/partner" not in editor.paths or editor.length("events/partner") < 2:
        return None
    partner, disc = editor.values("events/partner"), editor.values("events/disc")
    row = row_in(editor, "events/partner", random)
    partner[row] = disc[row]
    editor.store("events/partner", partner)
    return broken("a disc that meets itself", "events/disc", "events/partner", "events/kind")


def kind_and_partner(editor: Editor, random: Generator) -> Effect | None:
    """A disc that is called a wall, or a wall that is called a disc."""
    if "events/partner" not in editor.paths or editor.length("events/partner") < 2:
        return None
    kind, partner = editor.values("events/kind"), editor.values("events/partner")
    row = row_in(editor, "events/partner", random)
    kind[row] = Kind.DISC if partner[row] < 0 else random.choice([Kind.WALL, Kind.WALL_END, Kind.PISTON, Kind.KICK])
    editor.store("events/kind", kind)
    return broken("a kind that is not its partner's", "events/kind", "events/partner")


def unknown_species(editor: Editor, random: Generator) -> Effect | None:
    species = editor.values("discs/species")
    value = (len(editor.file["discs/species_name"]), 60_000, 65_535)[random.integers(3)]
    species[random.integers(len(species))] = value
    editor.store("discs/species", species)
    return broken(f"{value} in", "discs/species")


def not_positive(editor: Editor, random: Generator) -> Effect | None:
    path = some(random, [path for path in ("discs/radius", "discs/mass", "box") if path in editor.file])
    assert path is not None
    value = (0.0, -1.0, -1e300, -5e-324)[random.integers(4)]
    put(editor, path, int(random.integers(editor.length(path))), value, random)
    return broken(f"{value} in", path)


def outside(editor: Editor, random: Generator) -> Effect | None:
    """A centre outside the box."""
    path = some(random, [path for path in ("events/position",) if path in editor.paths and editor.length(path) > 1])
    if path is None:
        return None
    size = float(editor.values("box").max())
    value = (-0.5 * size, 2 * size, -1e9, 1e300)[random.integers(4)]
    put(editor, path, row_in(editor, path, random), value, random)
    return broken(f"{value} in", path)


def out_of_order(editor: Editor, random: Generator) -> Effect | None:
    """Times or counts that go back."""
    orders = [EVENT_TIME, CHECKPOINT_TIME, CHECKPOINT_ROW]
    found = [path for path in orders if path in editor.paths and editor.length(path) > 2]
    found = [path for path in found if np.unique(editor.values(path)).size > 2]
    path = some(random, found)
    if path is None:
        return None
    values = editor.values(path)
    if random.random() < 0.5:
        values = values[::-1].copy()
    else:
        row = int(random.integers(1, len(values) - 1))
        values[row] = values.max() + 1
    editor.store(path, values)
    return broken("back in time:", path)


def before_the_start(editor: Editor, random: Generator) -> Effect | None:
    orders = [EVENT_TIME, CHECKPOINT_TIME, CHECKPOINT_ROW]
    path = some(random, [path for path in orders if path in editor.paths and editor.length(path) > 1])
    if path is None:
        return None
    values = editor.values(path)
    values[0] = -1 if random.random() < 0.5 else -(2**62)
    editor.store(path, values)
    return broken(f"{values[0]} in", path)


def shuffled_rows(editor: Editor, random: Generator) -> Effect | None:
    """Rows of one column in another order: each is sound, together they lie."""
    path = some(random, [path for path in with_rows(editor, "fiu", 2) if not path.endswith(("time", "row", "epoch"))])
    if path is None:
        return None
    editor.store(path, random.permutation(editor.values(path)))
    return orderly(f"{path} in another order")


def sample_order(editor: Editor, random: Generator) -> Effect | None:
    """Samples whose times or steps go back."""
    ends = tuple(f"/{column.name}" for column in SAMPLE_COLUMNS)
    found = [path for path in editor.paths if path.startswith(("observables", "particles")) and path.endswith(ends)]
    path = some(random, [path for path in found if editor.length(path) > 2])
    if path is None:
        return None
    values = editor.values(path)
    if values[0] > values[-1]:  # backwards already, and sound if turned round again
        return None
    editor.store(path, values[::-1].copy())
    return broken("backwards:", path) if path.endswith("time") else orderly(f"backwards: {path}")


CHANGES: tuple[Change, ...] = (
    not_finite,
    not_finite,
    strange,
    strange,
    all_strange,
    scaled,
    any_integer,
    any_integer,
    unknown_disc,
    unknown_partner,
    unknown_kind,
    partner_itself,
    kind_and_partner,
    unknown_species,
    not_positive,
    outside,
    out_of_order,
    before_the_start,
    shuffled_rows,
    sample_order,
)
"""Each is drawn as often as it stands here."""
