"""Where discs may be, and how far from a wall they are."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from idealgas.effects.wall import Wall
    from idealgas.scene.tables.box import Box

Point = tuple[float, float]


def images(centre: Point, radius: float, box: Box | None) -> Iterator[Point]:
    """A disc's centre, and those of its images that reach into the box through periodic sides."""
    shifts = []
    for axis in range(2):
        here = [0.0]
        if box is not None and box.periodic[axis]:
            if centre[axis] < radius:
                here.append(box.size[axis])
            if centre[axis] > box.size[axis] - radius:
                here.append(-box.size[axis])
        shifts.append(here)
    for dx in shifts[0]:
        for dy in shifts[1]:
            yield centre[0] + dx, centre[1] + dy


def overlaps(discs: Sequence[tuple[Point, float]]) -> Iterator[tuple[int, int, float]]:
    """Indices of two discs that overlap, the lower one first, and their distance; each disc is (centre, radius).

    Discs of about one radius, from a power of two to the next, share a grid with cells no smaller than their diameter.
    Each disc is compared with those of the nine cells around it in the grids of its own size and of larger ones, so
    the time is that of N log N, unless very many discs overlap.
    """
    size = [math.frexp(radius)[1] for _, radius in discs]  # radius < 2^size
    grids: dict[int, dict[tuple[int, int], list[int]]] = {level: {} for level in sorted(set(size))}
    for i, (centre, _) in enumerate(discs):
        grids[size[i]].setdefault(_cell(centre, size[i]), []).append(i)
    for i, (centre, radius) in enumerate(discs):
        for level, grid in grids.items():
            if level < size[i]:
                continue
            column, row = _cell(centre, level)
            for cell in ((column + c, row + r) for c in (-1, 0, 1) for r in (-1, 0, 1)):
                for k in grid.get(cell, ()):
                    other, reach = discs[k][0], radius + discs[k][1]
                    dx, dy = centre[0] - other[0], centre[1] - other[1]
                    if dx * dx + dy * dy < reach * reach and (k < i or level > size[i]):
                        yield min(i, k), max(i, k), math.hypot(dx, dy)


def _cell(centre: Point, size: int) -> tuple[int, int]:
    """Column and row of a point in a grid of cells of the width 2 * 2^size."""
    return math.floor(math.ldexp(centre[0], -size - 1)), math.floor(math.ldexp(centre[1], -size - 1))


def distance_to_wall(point: Point, wall: Wall) -> float:
    """Distance of a point from the nearest point of a wall of some length."""
    along = (wall.end[0] - wall.start[0], wall.end[1] - wall.start[1])
    x, y = point[0] - wall.start[0], point[1] - wall.start[1]
    share = min(max((x * along[0] + y * along[1]) / (along[0] ** 2 + along[1] ** 2), 0.0), 1.0)
    return math.hypot(x - share * along[0], y - share * along[1])
