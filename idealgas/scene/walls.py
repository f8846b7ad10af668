"""Walls of a scene by number: the sides of the box are walls 0 to 3, the segments follow."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from idealgas.columns import FIRST_SEGMENT, SIDES, Point, side_ends

if TYPE_CHECKING:
    from idealgas.scene.scene import Scene


class NumberedWall(NamedTuple):
    """Wall with name, ends (length), description of its action, and times from and until which it is absent.

    radius: of a fixed disc, whose ends are its centre, length; 0 for others.
    """

    name: str
    start: Point
    end: Point
    action: str
    absences: tuple[tuple[float, float], ...] = ()
    radius: float = 0.0

    @property
    def is_gate(self) -> bool:
        """Whether the wall opens at some time."""
        return bool(self.absences)

    def is_there(self, time: float) -> bool:
        """Whether the wall is present at a time."""
        return not any(opens <= time < closes for opens, closes in self.absences)


def number_walls(scene: Scene) -> list[NumberedWall]:
    """All walls in the order of their numbers."""
    walls = []
    for name, ends, side in zip(SIDES, side_ends(scene.box.size), scene.box.sides, strict=True):
        action = side if isinstance(side, str) else side.action
        if scene.piston and scene.piston.side == name:
            action = scene.piston.action
        walls.append(NumberedWall(name, *ends, action))
    for k, wall in enumerate(scene.walls, FIRST_SEGMENT):
        name = wall.name or f"wall {k}"
        walls.append(NumberedWall(name, wall.start, wall.end, wall.action, wall.absences, wall.radius))
    return walls


def walls_inside(scene: Scene) -> list[NumberedWall]:
    """Walls inside the box, in the order of the scene."""
    return number_walls(scene)[FIRST_SEGMENT:]
