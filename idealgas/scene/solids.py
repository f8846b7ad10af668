"""Solids: areas inside or outside closed curves of walls that the gas cannot enter."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from idealgas.physics.arc import toggles
from idealgas.physics.arc_geometry import NO_ARC, Point, bounds

if TYPE_CHECKING:
    from idealgas.effects.wall import WallTable
    from idealgas.scene.discs import FixedDisc


class Solids(NamedTuple):
    """Solids of a scene.

    Attributes:
        walls: walls of the solids, by which side of their curves is solid: "inside" or "outside".
        area: area of the box that is covered by solids and fixed discs, length²; open curves do not contribute.
        loose: number and loose end of each wall whose curve is not closed.
    """

    walls: dict[str, tuple[WallTable, ...]]
    area: float
    loose: tuple[tuple[int, Point], ...]

    def contain(self, points: np.ndarray) -> np.ndarray:
        """Return a mask (M,) that is true for points (M, 2) inside a solid."""
        inside = enclosed(points, self.walls["inside"])
        return inside | ~enclosed(points, self.walls["outside"]) if self.walls["outside"] else inside


NO_SOLIDS = Solids({"inside": (), "outside": ()}, 0.0, ())
"""The value for a scene without solids."""


@lru_cache(maxsize=4)
def find_solids(walls: tuple[WallTable | None, ...], box_area: float) -> Solids:
    """Find the solids that walls form in a box.

    Args:
        walls: the walls; None marks an invalid table.
        box_area: area of the box, length².
    """
    numbered = [(k, wall) for k, wall in enumerate(walls) if wall is not None and wall.solid is not None]
    kinds = {kind: tuple(wall for _, wall in numbered if wall.solid == kind) for kind in ("inside", "outside")}
    curves, loose = _curves(numbered)
    rectangles = {kind: np.array([_rectangle(wall) for wall in members]).T for kind, members in kinds.items()}
    areas = dict.fromkeys(kinds, 0.0)
    for curve in curves:
        first, kind = curve[0][0], str(curve[0][0].solid)
        (x, y), curve_ids = first.start, {id(wall) for wall, _ in curve}
        low, right, high = rectangles[kind]
        met = np.flatnonzero((low <= y) & (y <= high) & (x <= right))  # walls that a ray to the right may meet
        other_walls = [wall for wall in (kinds[kind][k] for k in met) if id(wall) not in curve_ids]
        within = bool(enclosed(np.array([first.start]), other_walls)[0])
        areas[kind] += (-1 if within else 1) * abs(math.fsum(_swept(*part) for part in curve))
    covered = areas["inside"] + (box_area - areas["outside"] if kinds["outside"] else 0.0)
    return Solids(kinds, covered, loose)


def enclosed(points: np.ndarray, walls: Iterable[WallTable]) -> np.ndarray:
    """Return a mask (M,) that is true for points (M, 2) enclosed by closed curves of walls, by the even–odd rule."""
    inside = np.zeros(len(points), bool)
    for wall in walls:
        x, y = (points - wall.start).T
        inside ^= toggles(x, y, *np.subtract(wall.end, wall.start), wall.arc or NO_ARC)
    return inside


def _rectangle(wall: WallTable) -> tuple[float, float, float]:
    """Return the lower, right and upper edges of the bounding rectangle of a wall."""
    (_, low), (right, high) = bounds(wall.start, wall.end, wall.arc)
    return low, right, high


def _curves(
    walls: Sequence[tuple[int, WallTable]],
) -> tuple[list[list[tuple[WallTable, bool]]], tuple[tuple[int, Point], ...]]:
    """Return the closed curves and the loose ends of walls.

    A curve is a list of walls, each with a flag that is true if the curve runs from the start of the wall to its end.
    A loose end is the number of a wall and the point at which no other wall, or more than one, continues it.
    """
    at: dict[tuple[str | None, Point], list[int]] = defaultdict(list)
    known = dict(walls)
    for k, wall in walls:
        for end in {wall.start, wall.end} if wall.start != wall.end else ():
            at[wall.solid, end].append(k)
    loose = tuple((there[0], end) for (_, end), there in at.items() if len(there) != 2)
    curves, left = [], {k: None for k, _ in walls}
    while left:
        first = k = next(iter(left))
        curve, place = [], known[k].start
        while k in left:
            del left[k]
            forwards = known[k].start == place
            curve.append((known[k], forwards))
            place = known[k].end if forwards else known[k].start
            k = next((neighbour for neighbour in at[known[k].solid, place] if neighbour != k), first)
        if place == known[first].start:
            curves.append(curve)
    return curves, loose


def _swept(wall: WallTable, forwards: bool) -> float:
    """Return the area swept counterclockwise by the line from the origin to a point moving along a wall, length²."""
    (x0, y0), (x1, y1) = wall.start, wall.end
    area = (x0 * y1 - x1 * y0) / 2
    if arc := wall.arc:
        area += arc.turn * arc.radius**2 * (arc.angle - math.sin(arc.angle)) / 2
    return area if forwards else -area


@lru_cache(maxsize=4)
def covered_area(discs: tuple[FixedDisc, ...], size: Point, periodic: tuple[bool, bool]) -> float:
    """Return the area of a box that is covered by fixed discs, length²; discs may overlap each other and the sides.

    By Green's theorem, an area is the counterclockwise integral of x dy along its boundary. The boundary of the covered
    area consists of arcs of the discs' rims and of segments of the sides:

        ┌──────────────────┐
        │    ╭───╮         │   rims: arcs that are in the box and not inside another disc contribute;
        │   │   ╭┼──╮    ╭─┤
        │   │   ││   │  │  │   right side: segments inside discs contribute, with x equal to the width of the box;
        │    ╰──┼╯   │   ╰─┤
        │        ╰──╯      │   other sides: no contribution, as x = 0 on the left and dy = 0 at the bottom and top.
        └──────────────────┘
    """
    width, height = size
    x, y, r = _images_in_box(discs, size, periodic)
    arcs = [(k, *arc) for k, hidden in enumerate(_hidden(x, y, r, size)) for arc in _gaps(hidden, 2 * math.pi)]
    if not arcs:  # discs that reach into the box without any rim in it cover it completely
        return width * height if len(r) else 0.0
    owner, (start, end) = np.array([k for k, *_ in arcs]), np.array([arc for _, *arc in arcs]).T
    # The integral of (x + r cos φ) r cos φ dφ from start to end, divided by r.
    swept = x[owner] * (np.sin(end) - np.sin(start))
    swept += r[owner] / 2 * (end - start + (np.sin(2 * end) - np.sin(2 * start)) / 2)
    half = np.sqrt(np.maximum(r**2 - (width - x) ** 2, 0.0))  # half the chord that lies on the right side
    side = np.clip((y - half, y + half), 0.0, height)[:, half > 0].T.tolist()
    free = math.fsum(high - low for low, high in _gaps(side, height))
    return math.fsum((r[owner] * swept).tolist()) + width * (height - free)


def _images_in_box(
    discs: tuple[FixedDisc, ...], size: Point, periodic: tuple[bool, bool]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return x, y and radius of all periodic images of discs that reach into a box, sorted by x, without duplicates."""
    shifts = ((-length, 0.0, length) if wraps else (0.0,) for length, wraps in zip(size, periodic, strict=True))
    moves = list(product(*shifts))
    x, y, r = images = np.array([(d.start[0] + dx, d.start[1] + dy, d.radius) for d in discs for dx, dy in moves]).T
    reaches = (x > -r) & (x < size[0] + r) & (y > -r) & (y < size[1] + r)
    x, y, r = np.unique(images[:, reaches], axis=1)
    return x, y, r


def _hidden(x: np.ndarray, y: np.ndarray, r: np.ndarray, size: Point) -> list[list[tuple[float, float]]]:
    """Return the intervals of angle in which each disc's rim is inside another disc or outside the box.

    Every overlapping disc and every side hides the part of the rim beyond a straight line, which is the line through
    the two points where the rims cross, or the side itself. If the line is at distance h from the disc's centre, in
    direction θ, it hides all angles within arccos(h/r) of θ. Intervals may be empty.

           ╭───┬╮
          │    │ │        r cos(φ - θ) > h
          │  · │ │ ──→ θ
          │    │ │        For another disc of radius R at distance d, h = (d + (r² - R²)/d)/2, because half
           ╰───┴╯         the common chord has the squared length r² - h² = R² - (d - h)².
             └─┘
              h
    """
    disc, partner = _crossing(x, y, r)
    dx, dy = x[partner] - x[disc], y[partner] - y[disc]
    distance = np.hypot(dx, dy)
    within = distance <= r[partner] - r[disc]  # the whole disc is inside the partner
    chord = (distance + (r[disc] ** 2 - r[partner] ** 2) / np.where(within, 1.0, distance)) / 2
    # The overlapping partners of all discs, followed by the right, upper, left and lower sides for each disc.
    owner = np.concatenate((disc, *[np.arange(len(r))] * 4))
    towards = np.concatenate((np.arctan2(dy, dx), *(np.full(len(r), k * math.pi / 2) for k in range(4))))
    line = np.concatenate((np.where(within, -r[disc], chord), size[0] - x, size[1] - y, x, y))
    half = np.arccos(np.clip(line / r[owner], -1.0, 1.0))
    low, width = (towards - half) % (2 * math.pi), 2 * half
    hidden: list[list[tuple[float, float]]] = [[] for _ in r]
    for k, first, last in zip(owner.tolist(), low.tolist(), (low + width).tolist(), strict=True):
        hidden[k].append((first, last))
        hidden[k].append((0.0, last - 2 * math.pi))  # the part beyond a full turn, if any
    return hidden


def _crossing(x: np.ndarray, y: np.ndarray, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the indices of each disc and of a partner that covers part of its rim, for discs sorted by x."""
    indices = np.arange(len(r))
    # Pair each disc with the later discs whose x differs by at most the largest diameter.
    number = x.searchsorted(x + 2 * r.max(initial=0.0), "right") - indices - 1
    low = np.repeat(indices, number)
    high = low + 1 + np.arange(len(low)) - np.repeat(np.cumsum(number) - number, number)
    disc, partner = np.concatenate((low, high)), np.concatenate((high, low))
    distance = np.hypot(x[partner] - x[disc], y[partner] - y[disc])
    # The two overlap, and the partner is not inside the disc.
    crosses = (distance < r[disc] + r[partner]) & (distance > r[disc] - r[partner])
    return disc[crosses], partner[crosses]


def _gaps(covered: Iterable[tuple[float, float]], length: float) -> Iterator[tuple[float, float]]:
    """Yield the parts of the interval from 0 to `length` that are not covered by the given intervals.

    Given intervals that end before they begin are ignored.
    """
    reached = 0.0
    for low, high in sorted(covered):
        if low >= length:
            break
        if reached < low < high:
            yield reached, low
        if low < high:
            reached = max(reached, high)
    if reached < length:
        yield reached, length
