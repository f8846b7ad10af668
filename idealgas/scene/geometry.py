"""Where discs may be, and how far from a wall they are."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from idealgas.scene.tables.box import Box
    from idealgas.scene.tables.wall import Wall

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


def distance_to_wall(point: Point, wall: Wall) -> float:
    """Distance of a point from the nearest point of a wall of some length."""
    along = (wall.end[0] - wall.start[0], wall.end[1] - wall.start[1])
    x, y = point[0] - wall.start[0], point[1] - wall.start[1]
    share = min(max((x * along[0] + y * along[1]) / (along[0] ** 2 + along[1] ** 2), 0.0), 1.0)
    return math.hypot(x - share * along[0], y - share * along[1])
