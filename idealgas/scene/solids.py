"""Solids: what closed curves of walls enclose, or leave outside, so that no gas is there."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import pairwise, product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from idealgas.physics.arc import toggles
from idealgas.physics.arc_geometry import NO_ARC, Point, bounds

if TYPE_CHECKING:
    from idealgas.effects.wall import FixedDisc, Wall


class Solids(NamedTuple):
    """Solids of a scene.

    Attributes:
        walls: of the solids, by what is solid of their curves: "inside" or "outside".
        area: of the box that they and fixed discs cover, length²; without that beyond open curves.
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

NODES, WEIGHTS = np.polynomial.legendre.leggauss(32)
"""Nodes and weights of the integral of a length that discs cover, on -1 to 1."""


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


def _curves(walls: Sequence[tuple[int, Wall]]) -> tuple[list[list[tuple[Wall, bool]]], tuple[tuple[int, Point], ...]]:
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


@lru_cache(maxsize=4)
def covered_area(discs: tuple[FixedDisc, ...], size: Point, periodic: tuple[bool, bool]) -> float:
    """Area of a box that fixed discs cover, length², however they overlap each other and its sides.

    It is the integral over x of the length along y that they cover, from each place where that is not smooth to the
    next: where a disc begins or ends, and where two rims, or a rim and a side, cross.
    """
    width, height = size
    shifts = ((-length, 0.0, length) if wraps else (0.0,) for length, wraps in zip(size, periodic, strict=True))
    moves = list(product(*shifts))
    x, y, radius = np.array([(d.start[0] + dx, d.start[1] + dy, d.radius) for d in discs for dx, dy in moves]).T
    rims = (x - radius, x + radius, _crossings(x, y, radius), *(_heights(x, y, radius, y0) for y0 in (0.0, height)))
    places, area = np.unique(np.clip(np.concatenate(((0.0, width), *rims)), 0.0, width)), 0.0
    for start, end in pairwise(places.tolist()):
        middle, half, angle = (start + end) / 2, (end - start) / 2, (NODES + 1) * math.pi / 2
        here = np.abs(middle - x) < radius
        across = (middle - half * np.cos(angle))[:, None] - x[here]
        chord = np.sqrt(np.maximum(radius[here] ** 2 - across**2, 0.0))
        low, high = np.clip((y[here] - chord, y[here] + chord), 0.0, height)
        order = low.argsort(axis=1)
        low, high = np.take_along_axis(low, order, axis=1), np.take_along_axis(high, order, axis=1)
        reached = np.maximum.accumulate(np.insert(high, 0, 0.0, axis=1), axis=1)[:, :-1]
        length = np.maximum(high - np.maximum(low, reached), 0.0).sum(axis=1)
        area += half * math.pi / 2 * float(WEIGHTS @ (length * np.sin(angle)))
    return area


def _crossings(x: np.ndarray, y: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Places along x where the rims of two discs cross."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(np.column_stack((x, y))).query_pairs(2 * float(radius.max()), output_type="ndarray")
    one, other = pairs[(x[pairs[:, 0]] != x[pairs[:, 1]]) | (y[pairs[:, 0]] != y[pairs[:, 1]])].T
    dx, dy = x[other] - x[one], y[other] - y[one]
    square = dx**2 + dy**2
    along = (1 + (radius[one] ** 2 - radius[other] ** 2) / square) / 2
    across = radius[one] ** 2 / square - along**2
    some = across > 0
    foot, aside = (x[one] + along * dx)[some], np.sqrt(across[some]) * dy[some]
    return np.concatenate((foot - aside, foot + aside))


def _heights(x: np.ndarray, y: np.ndarray, radius: np.ndarray, height: float) -> np.ndarray:
    """Places along x where the rims of discs have a height."""
    square = radius**2 - (height - y) ** 2
    some = square > 0
    return np.concatenate((x[some] - np.sqrt(square[some]), x[some] + np.sqrt(square[some])))
