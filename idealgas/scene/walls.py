"""The walls of a scene by their numbers: 0 to 3 are the sides of the box, the segments follow."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from idealgas.columns import FIRST_SEGMENT, SIDES, Point, side_ends

if TYPE_CHECKING:
    from idealgas.scene.scene import Scene


class NumberedWall(NamedTuple):
    """name; start, end: length; action: what it does, in words; absence: times from and until which it is absent."""

    name: str
    start: Point
    end: Point
    action: str
    absence: tuple[float, float] = (math.inf, math.inf)

    @property
    def is_gate(self) -> bool:
        """Whether it is absent at some time."""
        return math.isfinite(self.absence[0])

    def is_there(self, time: float) -> bool:
        """Whether it is there at a time."""
        opens, closes = self.absence
        return not opens <= time < closes


def number_walls(scene: Scene) -> list[NumberedWall]:
    """All walls by number: the sides of the box are walls 0 to 3, the segments follow."""
    emits = scene.properties.emits
    walls = []
    for name, ends, side, temperature in zip(SIDES, side_ends(scene.box.size), scene.box.sides, emits, strict=False):
        action = str(side) if temperature is None else f"emits at temperature {temperature:g}"
        if scene.piston and scene.piston.side == name:
            action = scene.piston.action
        walls.append(NumberedWall(name, *ends, action))
    for k, wall in enumerate(scene.wall, FIRST_SEGMENT):
        walls.append(NumberedWall(wall.name or f"wall {k}", wall.start, wall.end, wall.action, wall.absence))
    return walls


def walls_inside(scene: Scene) -> list[NumberedWall]:
    """The walls inside the box, in the order of the scene."""
    return number_walls(scene)[FIRST_SEGMENT:]
