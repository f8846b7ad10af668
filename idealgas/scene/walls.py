"""Walls of a scene by number: the sides of the box are walls 0 to 3, the segments follow."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from idealgas.columns import FIRST_SEGMENT, SIDES, Point, side_ends

if TYPE_CHECKING:
    from idealgas.scene.scene import Scene


class NumberedWall(NamedTuple):
    """Wall with name, ends (length), description of its action, and times at which it opens and closes."""

    name: str
    start: Point
    end: Point
    action: str
    absence: tuple[float, float] = (math.inf, math.inf)

    @property
    def is_gate(self) -> bool:
        """Whether the wall opens at some time."""
        return math.isfinite(self.absence[0])

    def is_there(self, time: float) -> bool:
        """Whether the wall is present at a time."""
        opens, closes = self.absence
        return not opens <= time < closes


def number_walls(scene: Scene) -> list[NumberedWall]:
    """All walls in the order of their numbers."""
    emits = scene.properties.emits
    walls = []
    for name, ends, side, temperature in zip(SIDES, side_ends(scene.box.size), scene.box.sides, emits, strict=False):
        action = str(side) if temperature is None else f"thermal, temperature {temperature:g}"
        if scene.piston and scene.piston.side == name:
            action = scene.piston.action
        walls.append(NumberedWall(name, *ends, action))
    for k, wall in enumerate(scene.wall, FIRST_SEGMENT):
        walls.append(NumberedWall(wall.name or f"wall {k}", wall.start, wall.end, wall.action, wall.absence))
    return walls


def walls_inside(scene: Scene) -> list[NumberedWall]:
    """Walls inside the box, in the order of the scene."""
    return number_walls(scene)[FIRST_SEGMENT:]
