"""Wall segments inside the box, which may be gates."""

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from pydantic import Field

from idealgas.columns import SIDES
from idealgas.effects.effect import EffectSpec, Sample, Start, Tables
from idealgas.effects.properties import Properties
from idealgas.jit import aligned
from idealgas.physics import wall as law
from idealgas.toml.issues import Issue, Key
from idealgas.toml.table import Positive, Table, Vector, Word

SHORTEST = 1e-9
"""Length of a wall in units of the box's longer side: below, a double cannot tell its ends apart."""


class Wall(Table):
    """`[[wall]]`: a segment whose body and ends are solid, at rest. One that opens or closes is a gate.

    It is there until `opens_at`, and again from `closes_at` on; with `closes_at` alone it is absent until then. A disc
    in the way of a closing gate stays on the side of its centre: it may leave, and bounces where it comes nearer. One
    that cannot rise out against gravity bounces as deep in the gate as it is.
    """

    start: Vector = Field(alias="from", description="[x, y] of one end, length")
    end: Vector = Field(alias="to", description="[x, y] of the other end, length")
    temperature: Positive | None = Field(
        default=None, description="temperature > 0, energy, of a thermal wall; reflecting if absent"
    )
    opens_at: Positive | None = Field(default=None, description="time > 0 at which it is removed")
    closes_at: Positive | None = Field(default=None, description="time > 0 at which it is inserted")
    name: Word | None = Field(default=None, description="unique word for the log; if absent its number")

    @property
    def absence(self) -> tuple[float, float]:
        """Times from and until which it is absent; both infinite for a wall that is always present."""
        if self.opens_at is None and self.closes_at is not None:
            return 0.0, self.closes_at
        return self.opens_at or math.inf, self.closes_at or math.inf

    @property
    def action(self) -> str:
        """Short description for output."""
        action = "reflecting" if self.temperature is None else f"thermal, temperature {self.temperature:g}"
        opens, closes = self.absence
        if math.isinf(opens):
            return action
        return f"{action}, open from {opens:g}" + ("" if math.isinf(closes) else f" to {closes:g}")

    def after(self, time: float) -> "Wall | None":
        """The wall in a scene whose clock starts at a later time; None if it has been removed for good."""
        opens, closes = self.absence
        if opens <= time and math.isinf(closes):
            return None
        later = {"opens_at": opens - time if time < opens < math.inf else None}
        later["closes_at"] = closes - time if time < closes < math.inf else None
        return self.model_copy(update=later)

    @property
    def there_at_start(self) -> bool:
        """Whether it is there at time 0."""
        return self.absence[0] > 0


def _properties(tables: Tables) -> Properties:
    absences = (wall.absence for wall in tables.own if wall is not None)
    removed = (opens if math.isinf(closes) else math.inf for opens, closes in absences)
    return Properties(
        uniform=False,
        allows_monte_carlo=False,
        allows_time_steps=False,
        is_scalable=False,
        last_wall_removed_at=max(removed),
    )


def _check(tables: Tables) -> Iterator[Issue]:
    """Walls with faults of their own, and names that are taken."""
    first: dict[str, int] = {}
    for i, wall in enumerate(tables.own):
        if wall is None:
            continue
        yield from wall_issues(tables.size, i, wall)
        if wall.name in SIDES:
            yield Issue((("wall", i, "name"),), "name taken by a side of the box", f'"{wall.name}"', "any other word")
        elif wall.name is not None and first.setdefault(wall.name, i) != i:
            yield Issue((("wall", i, "name"),), "second wall of this name", f'"{wall.name}"', "a name of its own")


def wall_issues(size: tuple[float, float], i: int, wall: Wall) -> Iterator[Issue]:
    """Faults of one wall in a box of a size, except for its name."""
    keys: tuple[Key, ...] = (("wall", i, "from"), ("wall", i, "to"))
    ends = f"{list(wall.start)} to {list(wall.end)}"
    if not all(0 <= end[axis] <= size[axis] for end in (wall.start, wall.end) for axis in range(2)):
        allowed = f"0 <= x <= {size[0]} and 0 <= y <= {size[1]} at both ends"
        yield Issue((*keys, ("box", "size")), "wall not in the box", ends, allowed)
    length = math.hypot(wall.end[0] - wall.start[0], wall.end[1] - wall.start[1])
    if length < SHORTEST * max(size):
        yield Issue(keys, "a wall of no length", ends, f"a length >= {SHORTEST * max(size)}")
    elif any(wall.start[a] == wall.end[a] in (0, size[a]) for a in range(2)):
        yield Issue(keys, "a wall along a side of the box", ends, "walls inside the box; a side is a wall already")
    if wall.opens_at is not None and wall.closes_at is not None and wall.closes_at <= wall.opens_at:
        keys = (("wall", i, "closes_at"), ("wall", i, "opens_at"))
        yield Issue(keys, "closes before it opens", f"{wall.closes_at}", f"> {wall.opens_at}")


def make_segments(
    start: np.ndarray, end: np.ndarray, opens: np.ndarray | float = math.inf, closes: np.ndarray | float = math.inf
) -> np.recarray:
    """(S,) SEGMENT at time 0. start, end: (S, 2). opens, closes: times from and until which each is absent."""
    segments = aligned(len(start), law.SEGMENT)
    segments.x, segments.y = start.T
    segments.length = np.hypot(*(end - start).T)
    segments.tx, segments.ty = ((end - start) / segments.length[:, None]).T
    segments.opens, segments.closes = opens, closes
    segments.active = segments.opens > 0
    return segments


def _make(tables: Tables, _: Start) -> np.recarray:
    start, end, absence = (
        np.array([getattr(wall, name) for wall in tables.own]) for name in ("start", "end", "absence")
    )
    return make_segments(start, end, *absence.T)


def _polygon(side: float, corners: int, height: float, radius: float = 4.0) -> str:
    """Tables `[[wall]]` of a regular polygon of `radius` (length) with its centre at `height` in the box."""
    turn = [2 * math.pi * k / corners for k in range(corners + 1)]
    points = [[side / 2 + radius * math.cos(a), height + radius * math.sin(a)] for a in turn]
    return "".join(f"[[wall]]\nfrom = {start}\nto = {end}\n" for start, end in pairwise(points))


EFFECT = EffectSpec(
    name="wall segments",
    field="segments",
    key="wall",
    table=Wall,
    many=True,
    description="[[wall]] tables",
    properties=_properties,
    check=_check,
    make=_make,
    begin_epoch=law.begin_epoch,
    next_change=law.next_change,
    samples=(
        Sample("6", tables=lambda side: _polygon(side, 6, side / 2)),
        Sample("1000", tables=lambda side: _polygon(side, 1000, side / 2)),
    ),
    sample_together=Sample(tables=lambda side: _polygon(side, 6, 5.0)),
)
