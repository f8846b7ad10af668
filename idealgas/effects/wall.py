"""Walls inside the box, straight or arcs, which may be gates."""

import math
from collections.abc import Container, Iterator
from itertools import pairwise, zip_longest
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from idealgas.columns import SIDES
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Later, Tables
from idealgas.effects.properties import Properties
from idealgas.effects.schedule import Change, SteppedTable, Times, WallTemperature, as_times, description, times_key
from idealgas.jit import aligned
from idealgas.physics import wall as law
from idealgas.physics.arc_geometry import Arc, arc_through
from idealgas.toml.issues import Issue, Key, issues_error
from idealgas.toml.table import Vector, Word


class WallTable(SteppedTable):
    """`[[wall]]`: a segment or arc at rest, whose body and ends are solid. A wall that opens or closes is a gate.

    A table with `points` declares the pieces of a polygonal line, and all its other keys apply to every piece.

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
    refused = dict.fromkeys(
        ("ellipse", "axes", "semi_axes"),
        (
            "elliptical walls are not available",
            "straight walls, polygons (points) and arcs (from, via, to): 32 arcs follow an ellipse with semi-axes 2a "
            "and a to within 2.3e-4 a, and the error of n arcs falls as 1/n³; see Ellipses in configs/README.md",
        ),
    )

    from_: Vector | None = Field(default=None, alias="from", description="[x, y] of one end, length")
    to: Vector | None = Field(default=None, description="[x, y] of the other end, length")
    via: Vector | None = Field(
        default=None,
        description="[x, y] of a point on the arc between the ends, length; for a circle, the point opposite its start",
    )
    points: Annotated[tuple[Vector, ...], Field(strict=False)] | None = Field(
        default=None, description="[x, y] of the corners of a polygonal line, instead of from and to, length"
    )
    closed: bool | None = Field(
        default=None, description="with points: whether the last point is joined to the first, as in a polygon"
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

    _number: int = PrivateAttr(0)  # of the table
    _corners: tuple[int, ...] = PrivateAttr(())  # numbers of the points that a piece of a polygonal line joins

    @model_validator(mode="after")
    def _check_shape(self) -> Self:
        """Raise an error unless there are either both ends or enough points."""
        ends = {"from": self.from_, "to": self.to, "via": self.via}
        missing = [key for key in ("from", "to") if ends[key] is None]
        given, fewest, issue = [key for key in ends if ends[key] is not None], 3 if self.closed else 2, None
        if self.points is None and self.closed is not None:
            issue = Issue((("closed",),), "nothing to close", "no points", "closed together with points")
        elif self.points is None and missing:
            allowed = "[x, y] of the other end, length" if given else "from and to, [x, y] of both ends, or points"
            issue = Issue(((missing[0],),), "missing", "nothing", allowed)
        elif self.points is not None and given:
            keys = (("points",), *((key,) for key in given))
            issue = Issue(keys, "two shapes", f"points and {', '.join(given)}", "either points, or from and to")
        elif self.points is not None and len(self.points) < fewest:
            issue = Issue((("points",),), "too few points", str(len(self.points)), f">= {fewest}")
        if issue:
            raise issues_error([issue])
        return self

    def pieces(self, number: int) -> "tuple[WallTable, ...]":
        """Return the walls that the table declares: the segments of a polygonal line, or a single wall.

        Only the text of a scene contains polygonal lines; everything else deals with their pieces.

        number: number of the table.
        """
        points = self.points or ()
        corners = [*range(len(points)), *([0] if self.closed else [])]
        pieces = []
        for joined in pairwise(corners) if points else [()]:
            ends = dict(zip(("from_", "to"), (points[k] for k in joined), strict=False))
            piece = self.model_copy(update={**ends, "points": None, "closed": None})
            piece._number, piece._corners = number, joined
            pieces.append(piece)
        return tuple(pieces)

    @property
    def start(self) -> Vector:
        """First end of a piece."""
        assert self.from_ is not None, "a polygonal line has pieces"
        return self.from_

    @property
    def end(self) -> Vector:
        """Second end of a piece."""
        assert self.to is not None, "a polygonal line has pieces"
        return self.to

    @property
    def piece(self) -> int | None:
        """Index of this piece in its polygonal line, whose piece k begins at point k; None for other walls."""
        return self._corners[0] if self._corners else None

    def key(self, *names: str | int) -> Key:
        """Return the path of a key of the table in the scene."""
        return ("wall", self._number, *names)

    declared = property(key)  # path of the table

    @property
    def ends_keys(self) -> tuple[Key, ...]:
        """Keys of both ends."""
        return tuple(self.key("points", k) for k in self._corners) or (self.key("from"), self.key("to"))

    @property
    def place(self) -> Key:
        """Key of the wall or, for a piece of a polygonal line, of its first point."""
        return self.ends_keys[0] if self._corners else self.declared

    @property
    def title(self) -> str:
        """Name in messages."""
        between = " between points {} and {}".format(*self._corners) if self._corners else ""
        return f"wall {self.name or self._number}{between}"

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

    temperature = permeable_from = arc = solid = piece = None
    absences = ()
    is_permeable = absorbing = False
    title = property(lambda self: self.name)  # in messages
    declared = property(lambda self: self.place)

    def is_present(self, _: float) -> bool:
        """Whether the wall is present at a time."""
        return True

    def lets_pass(self, _: str) -> bool:
        """Whether the wall lets discs of a species pass."""
        return False


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
    """`[[wall]]` table of a regular polygon of radius 4 whose centre is at the given height in the box."""
    turn = [2 * math.pi * k / corners for k in range(corners)]
    points = [[side / 2 + 4.0 * math.cos(a), height + 4.0 * math.sin(a)] for a in turn]
    return f"[[wall]]\npoints = {points}\nclosed = true\n"


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
