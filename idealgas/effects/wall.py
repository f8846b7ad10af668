"""Walls inside the box, straight or arcs, which may be gates."""

import math
from collections.abc import Container, Iterator
from dataclasses import dataclass
from itertools import pairwise, zip_longest
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from idealgas.columns import SIDES
from idealgas.effects.arc import FLATTEST
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Later, Tables
from idealgas.effects.properties import Properties
from idealgas.effects.schedule import Change, SteppedTable, Times, WallTemperature, as_times, description, times_key
from idealgas.jit import aligned
from idealgas.physics import wall as law
from idealgas.physics.arc_geometry import Arc, arc_through, bounds
from idealgas.toml.issues import Issue, Key
from idealgas.toml.table import Vector, Word

SHORTEST = 1e-9
"""Shortest wall in units of the box's longer side; double precision cannot separate the ends of a shorter wall."""


class WallTable(SteppedTable):
    """`[[wall]]`: a segment or arc at rest, whose body and ends are solid. A wall that opens or closes is a gate.

    A gate is present until `opens_at`, and again from `closes_at` on. If only `closes_at` is given, the gate is absent
    until then. Lists of times open and close the gate repeatedly; if `opens_at` begins with 0, the gate is absent at
    the start. If a gate closes on a disc, the disc remains on the side of its centre: it may leave, and it bounces if
    it moves closer. A disc that gravity keeps from leaving the gate bounces at its current depth.

    Discs of the species `permeable_to` pass a wall as if it were absent. If `permeable_from` is given, they pass from
    that side only. Beyond the wall, a disc bounces when it touches the wall or, while it still overlaps the wall, when
    its centre returns to the wall; the ends are solid. An `absorbing` wall removes discs from the gas where another
    wall would reflect them.
    """

    in_steps = ("temperature",)
    radius: ClassVar[float] = 0.0

    start: Vector = Field(alias="from", description="[x, y] of one end, length")
    end: Vector = Field(alias="to", description="[x, y] of the other end, length")
    via: Vector | None = Field(
        default=None,
        description="[x, y] of a point on the arc between the ends, length; for a circle, the point opposite its start",
    )
    solid: Literal["inside", "outside"] | None = Field(
        default=None, description="side without gas: inside or outside the closed curve of walls that have this key"
    )
    temperature: WallTemperature | None = Field(
        default=None, description="temperature of a thermal wall, as for a thermal side; reflecting if absent"
    )
    opens_at: Times | None = Field(default=None, description="time > 0, or times, at which it is removed")
    closes_at: Times | None = Field(default=None, description="time > 0, or times, at which it is inserted")
    permeable_to: Annotated[tuple[Word, ...], Field(strict=False, min_length=1)] | None = Field(
        default=None, description="species that can pass the wall; all if only `permeable_from` is given"
    )
    permeable_from: Literal[SIDES] | None = Field(  # type: ignore[valid-type]
        default=None, description="side of the wall from which these species can pass; both sides if absent"
    )
    absorbing: bool = Field(default=False, description="whether it is a hole: discs that touch it leave the gas")
    name: Word | None = Field(
        default=None, description="unique name in the log, a word; if absent, the number of the wall is used"
    )

    @property
    def arc(self) -> Arc | None:
        """Arc of the wall; None for a straight wall."""
        return self.via and arc_through(self.start, self.via, self.end)

    @property
    def absences(self) -> tuple[tuple[float, float], ...]:
        """Intervals (start, end) in time during which the wall is absent, in order; the last end may be infinite."""
        opens, closes = (as_times(times) for times in (self.opens_at or 0.0, self.closes_at))
        if self.opens_at is None and self.closes_at is None:
            return ()
        return tuple(zip_longest(opens, closes, fillvalue=math.inf))

    @property
    def action(self) -> str:
        """Short description for output."""
        action = "absorbing" if self.absorbing else "reflecting"
        if self.temperature is not None:
            action = f"thermal, temperature {description(self.temperature)}"
        if arc := self.arc:
            action = f"{'circle' if self.start == self.end else 'arc'} of radius {arc.radius:.6g}, {action}"
        if self.is_permeable:
            action += f", permeable to {' and '.join(self.permeable_to or ('all discs',))}"
            action += f" from the {self.permeable_from}" if self.permeable_from else ""
        spans = (f"from {o:g}" + ("" if math.isinf(c) else f" to {c:g}") for o, c in self.absences)
        return ", open ".join((action, ", ".join(spans))) if self.absences else action

    @property
    def is_permeable(self) -> bool:
        """Whether the wall lets any disc pass."""
        return self.permeable_to is not None or self.permeable_from is not None

    def lets_pass(self, species: str) -> bool:
        """Whether the wall lets discs of a species pass, from at least one side."""
        return self.is_permeable and (self.permeable_to is None or species in self.permeable_to)

    def later(self, time: float) -> "WallTable | None":
        """Return the wall for a scene whose clock starts at a later time; None if it has been removed for good."""
        absences = [(max(o - time, 0.0), c - time) for o, c in self.absences if c > time]
        if absences and absences[0] == (0.0, math.inf):
            return None
        opens, closes = ([t[k] for t in absences if t[k] < math.inf] for k in range(2))
        update = {"opens_at": times_key([] if opens == [0.0] else opens), "closes_at": times_key(closes)}
        return self.after(time).model_copy(update=update)

    def for_species(self, species: Container[str]) -> "WallTable":
        """Return the wall for a gas of these species only; if none of them may pass, no disc may pass the wall."""
        if self.permeable_to is None:
            return self
        names = tuple(name for name in self.permeable_to if name in species)
        update = {"permeable_to": names} if names else {"permeable_to": None, "permeable_from": None}
        return self.model_copy(update=update)

    def is_present(self, time: float) -> bool:
        """Whether the wall is present at a time."""
        return not any(opens <= time < closes for opens, closes in self.absences)


class PermanentWall:
    """A wall that is not declared in `[[wall]]`; it is always present, straight, not thermal and not permeable."""

    temperature = permeable_from = arc = None
    absences = ()
    is_permeable = absorbing = False

    def is_present(self, _: float) -> bool:
        """Whether the wall is present at a time."""
        return True

    def lets_pass(self, _: str) -> bool:
        """Whether the wall lets discs of a species pass."""
        return False


@dataclass(frozen=True)
class FixedDisc(PermanentWall):
    """A fixed disc: a wall around a point.

    Attributes:
        number: number of its `[[disc]]` table.
        start: centre, length.
        radius: length.
    """

    number: int
    start: tuple[float, float]
    radius: float

    @property
    def end(self) -> tuple[float, float]:
        """Centre of the disc."""
        return self.start

    @property
    def place(self) -> Key:
        """Key that declares the disc as fixed."""
        return ("disc", self.number, "fixed")

    @property
    def name(self) -> str:
        """Name for the log."""
        return f"fixed disc {self.number}"

    @property
    def action(self) -> str:
        """Short description for output."""
        return f"fixed disc, radius {self.radius:g}"


def wall_issues(size: tuple[float, float], i: int, wall: WallTable) -> Iterator[Issue]:
    """Yield issues of wall i, except for its name.

    size: width and height of the box, length.
    """
    keys: tuple[Key, ...] = (("wall", i, "from"), ("wall", i, "to"))
    ends = f"{list(wall.start)} to {list(wall.end)}"
    length = math.dist(wall.start, wall.end)
    if wall.via is not None:
        keys, ends = (("wall", i, "via"), *keys), f"{list(wall.start)} via {list(wall.via)} to {list(wall.end)}"
        arc, farthest = wall.arc, FLATTEST * max(size)
        nearest = min(math.dist(wall.via, wall.start), math.dist(wall.via, wall.end))
        if arc is None or arc.radius > farthest or nearest < SHORTEST * max(size):
            yield Issue(keys, "no arc through these points", ends, f"points not on a line, a radius <= {farthest:g}")
            return
    low, high = bounds(wall.start, wall.end, wall.arc)
    slack = SHORTEST * max(size) if wall.via else 0.0  # rounding of an arc
    if not all(-slack <= low[axis] and high[axis] <= size[axis] + slack for axis in range(2)):
        allowed = f"0 <= x <= {size[0]} and 0 <= y <= {size[1]} everywhere"
        yield Issue((*keys, ("box", "size")), "wall not in the box", ends, allowed)
    if wall.via is not None and wall.start == wall.end:
        pass
    elif length < SHORTEST * max(size):
        yield Issue(keys, "wall too short", ends, f"a length >= {SHORTEST * max(size)}")
    elif wall.via is None and any(wall.start[a] == wall.end[a] in (0, size[a]) for a in range(2)):
        yield Issue(
            keys, "a wall along a side of the box", ends, "walls inside the box; the sides of the box are already walls"
        )
    times = [time for absence in wall.absences for time in absence]
    if wall.is_permeable and wall.solid:
        keys = (("wall", i, "solid"), ("wall", i, "permeable_to"), ("wall", i, "permeable_from"))
        yield Issue(keys, "a solid that lets discs pass", f'"{wall.solid}" and a permeable wall', "only one of them")
    if wall.absorbing and wall.temperature is not None:
        keys = (("wall", i, "absorbing"), ("wall", i, "temperature"))
        yield Issue(keys, "an absorbing wall with a temperature", str(wall.temperature), "only one of them")
    if times and wall.solid:
        keys = (("wall", i, "solid"), ("wall", i, "opens_at"), ("wall", i, "closes_at"))
        yield Issue(keys, "a solid that opens", f'"{wall.solid}" and a gate', "only one of them")
    if any(later <= earlier for earlier, later in pairwise(times)):
        keys = (("wall", i, "closes_at"), ("wall", i, "opens_at"))
        opens, closes = as_times(wall.opens_at), as_times(wall.closes_at)
        single = len(opens) == len(closes) == 1
        allowed = f"> {wall.opens_at}" if single else "times in order, each opening before its closing"
        wrong = "closes before it opens" if single else "openings and closings do not alternate"
        yield Issue(keys, wrong, str(closes[0]) if single else f"{list(closes)} after {list(opens)}", allowed)


def make_segments(
    start: np.ndarray, end: np.ndarray, active: np.ndarray | bool = True, radius: np.ndarray | float = 0.0
) -> np.recarray:
    """Return wall segments (S,) SEGMENT.

    start, end: (S, 2) end points, length. active: whether each segment is present. radius: radius of fixed discs, which
    are segments of length 0; 0 for walls.
    """
    segments = aligned(len(start), law.SEGMENT)
    segments.x, segments.y = start.T
    segments.length = np.hypot(*(end - start).T)
    round_ones = segments.length == 0
    segments.tx, segments.ty = ((end - start) / np.where(round_ones, 1.0, segments.length)[:, None]).T
    segments.tx[round_ones] = 1.0
    segments.active, segments.radius = active, radius
    return segments


def _polygon(side: float, corners: int, height: float) -> str:
    """`[[wall]]` tables of a regular polygon of radius 4 whose centre is at the given height in the box."""
    turn = [2 * math.pi * k / corners for k in range(corners + 1)]
    points = [[side / 2 + 4.0 * math.cos(a), height + 4.0 * math.sin(a)] for a in turn]
    return "".join(f"[[wall]]\nfrom = {start}\nto = {end}\n" for start, end in pairwise(points))


class WallEffect(Effect[np.recarray]):
    """Walls inside the box, straight or arcs, which may be gates."""

    name = "wall segments"
    field = "segments"
    key = "wall"
    table = WallTable
    many = True
    description = "[[wall]] tables"
    samples = (
        BenchmarkSample("6", tables=lambda side: _polygon(side, 6, side / 2)),
        BenchmarkSample("1000", tables=lambda side: _polygon(side, 1000, side / 2)),
    )
    sample_together = BenchmarkSample(tables=lambda side: _polygon(side, 6, 5.0) + "temperature = 1\n")

    def properties(self, tables: Tables) -> Properties:
        walls = [wall for wall in tables.table if wall is not None]
        removed = (wall.absences[-1] if wall.absences else (math.inf, math.inf) for wall in walls)
        times = {t for wall in walls for absence in wall.absences for t in absence}
        return Properties(
            uniform=False,
            allows_monte_carlo=False,
            allows_time_steps=False,
            is_scalable=False,
            last_wall_removed_at=max(opens if math.isinf(closes) else math.inf for opens, closes in removed),
            changes=tuple(sorted(times - {0.0, math.inf})),
        )

    def check(self, tables: Tables) -> Iterator[Issue]:
        """Yield issues of individual walls, and of names that are taken."""
        first: dict[str, int] = {}
        for i, wall in enumerate(tables.table):
            if wall is None:
                continue
            if isinstance(wall, FixedDisc):
                if not all(0 <= x <= length for x, length in zip(wall.start, tables.size, strict=True)):
                    allowed = f"0 <= x <= {tables.size[0]} and 0 <= y <= {tables.size[1]}"
                    keys: tuple[Key, ...] = (("disc", wall.number, "position"), ("box", "size"))
                    yield Issue(keys, "fixed disc not in the box", str(list(wall.start)), allowed)
                continue
            yield from wall_issues(tables.size, i, wall)
            if wall.name in (*SIDES, "piston"):
                taken = "the piston" if wall.name == "piston" else "a side of the box"
                yield Issue((("wall", i, "name"),), f"name taken by {taken}", f'"{wall.name}"', "any other word")
            elif wall.name is not None and first.setdefault(wall.name, i) != i:
                yield Issue((("wall", i, "name"),), "second wall with this name", f'"{wall.name}"', "a unique name")

    def continued(self, table: tuple[WallTable, ...], later: Later) -> tuple[WallTable, ...]:
        walls = (wall.later(later.time) for wall in table)
        return tuple(wall.for_species(later.species) for wall in walls if wall is not None)

    def make(self, tables: Tables, _: GasAtStart) -> np.recarray:
        start, end = (np.array([getattr(wall, name) for wall in tables.table]) for name in ("start", "end"))
        active, radius = [wall.is_present(0.0) for wall in tables.table], [wall.radius for wall in tables.table]
        return make_segments(start, end, np.array(active), np.array(radius))

    def schedule(self, tables: Tables, _: GasAtStart) -> Iterator[Change]:
        for k, wall in enumerate(tables.table):
            for times, active in zip(zip(*wall.absences, strict=True), (0.0, 1.0), strict=False):
                yield from (Change(time, k, active) for time in times if 0 < time < math.inf)

    def change(self, segments: np.recarray, segment: int, active: float) -> np.recarray:
        segments.active[segment] = bool(active)
        return segments


EFFECT = WallEffect()
