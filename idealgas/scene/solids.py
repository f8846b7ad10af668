"""Solids: what closed curves of walls enclose, or leave outside, so that no gas is there."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from idealgas.physics.arc import toggles
from idealgas.physics.arc_geometry import NO_ARC, Point, bounds

if TYPE_CHECKING:
    from idealgas.effects.wall import Wall


class Solids(NamedTuple):
    """Solids of a scene.

    Attributes:
        walls: of the solids, by what is solid of their curves: "inside" or "outside".
        area: of the box that they cover, length²; without that beyond open curves.
        loose: number of a wall and its end, of which the curve is not closed.
    """

    walls: dict[str, tuple[Wall, ...]]
    area: float
    loose: tuple[tuple[int, Point], ...]

    def contain(self, points: np.ndarray) -> np.ndarray:
        """Mask (M,) of the points (M, 2) that are in a solid."""
        found = enclosed(points, self.walls["inside"])
        return found | ~enclosed(points, self.walls["outside"]) if self.walls["outside"] else found


NO_SOLIDS = Solids({"inside": (), "outside": ()}, 0.0, ())
"""Those of a scene without any."""


@lru_cache(maxsize=4)
def find_solids(walls: tuple[Wall | None, ...], box_area: float) -> Solids:
    """Solids that tables [[wall]] make in a box of some area, length²; None for invalid tables."""
    numbered = [(k, wall) for k, wall in enumerate(walls) if wall is not None and wall.solid is not None]
    kinds = {kind: tuple(wall for _, wall in numbered if wall.solid == kind) for kind in ("inside", "outside")}
    curves, loose = _curves(numbered)
    rectangles = {kind: np.array([_rectangle(wall) for wall in found]).T for kind, found in kinds.items()}
    areas = dict.fromkeys(kinds, 0.0)
    for curve in curves:
        first, kind = curve[0][0], str(curve[0][0].solid)
        (x, y), own = first.start, {id(wall) for wall, _ in curve}
        low, right, high = rectangles[kind]
        met = np.flatnonzero((low <= y) & (y <= high) & (x <= right))  # by a ray from the point to the right
        others = [wall for wall in (kinds[kind][k] for k in met) if id(wall) not in own]
        within = bool(enclosed(np.array([first.start]), others)[0])
        areas[kind] += (-1 if within else 1) * abs(math.fsum(_swept(*part) for part in curve))
    covered = areas["inside"] + (box_area - areas["outside"] if kinds["outside"] else 0.0)
    return Solids(kinds, covered, loose)


def enclosed(points: np.ndarray, walls: Iterable[Wall]) -> np.ndarray:
    """Mask (M,) of the points (M, 2) that closed curves of walls enclose, by the even–odd rule."""
    found = np.zeros(len(points), bool)
    for wall in walls:
        x, y = (points - wall.start).T
        found ^= toggles(x, y, *np.subtract(wall.end, wall.start), wall.arc or NO_ARC)
    return found


def _rectangle(wall: Wall) -> tuple[float, float, float]:
    """Lower, right and upper edge of the rectangle around a wall."""
    (_, low), (right, high) = bounds(wall.start, wall.end, wall.arc)
    return low, right, high


def _curves(
    walls: Sequence[tuple[int, Wall]],
) -> tuple[list[list[tuple[Wall, bool]]], tuple[tuple[int, Point], ...]]:
    """Closed curves, each of walls and whether it runs from start to end of each, and the loose ends of the others."""
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
            k = next((other for other in at[known[k].solid, place] if other != k), first)
        if place == known[first].start:
            curves.append(curve)
    return curves, loose


def _swept(wall: Wall, forwards: bool) -> float:
    """Area that the line from the origin to a point sweeps as it moves along a wall, counterclockwise, length²."""
    (x0, y0), (x1, y1) = wall.start, wall.end
    area = (x0 * y1 - x1 * y0) / 2
    if arc := wall.arc:
        area += arc.turn * arc.radius**2 * (arc.angle - math.sin(arc.angle)) / 2
    return area if forwards else -area
