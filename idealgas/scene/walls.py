"""Walls of a scene in order of their numbers: the sides of the box (walls 0 to 3), segments, and inner pistons."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from idealgas.columns import FIRST_SEGMENT, SIDES, Point, side_ends
from idealgas.effects.piston import InnerPiston
from idealgas.physics.arc_geometry import Arc, drawn_points

if TYPE_CHECKING:
    from idealgas.scene.scene import Scene


ARROWS = dict(zip(SIDES, "→←↑↓", strict=True))
"""Arrow in the direction in which discs pass a wall, by the side from which they come."""


class NumberedWall(NamedTuple):
    """A wall of a scene.

    Attributes:
        name: name of the wall in output.
        start: (x, y) of its first end, length.
        end: (x, y) of its second end, length.
        action: description of how the wall acts on discs.
        absences: times at which each absence of the wall begins and ends.
        radius: radius of a fixed disc, length, for which both ends are its centre; 0 for other walls.
        is_permeable: whether discs of at least one species pass through the wall.
        label: name of the wall in pictures, with an arrow if discs pass in one direction only.
        arc: the arc; None if the wall is not an arc.
        moves: whether the wall is an inner piston; its ends are then the ends at the start.
    """

    name: str
    start: Point
    end: Point
    action: str
    absences: tuple[tuple[float, float], ...] = ()
    radius: float = 0.0
    is_permeable: bool = False
    label: str = ""
    arc: Arc | None = None
    moves: bool = False

    @property
    def is_straight(self) -> bool:
        """Whether the wall is neither an arc nor a fixed disc."""
        return not self.radius and self.arc is None

    @property
    def length(self) -> float:
        """Length of the wall; for a fixed disc, its circumference."""
        straight = math.dist(self.start, self.end) + 2 * math.pi * self.radius
        return self.arc.length if self.arc else straight

    @property
    def points(self) -> list[Point]:
        """Corners of the polygonal line that is drawn for the wall."""
        return drawn_points(self.start, self.end, self.arc)

    @property
    def is_gate(self) -> bool:
        """Whether the wall is absent at any time."""
        return bool(self.absences)

    @property
    def is_passable(self) -> bool:
        """Whether any disc can pass the wall, because the wall opens or because of the disc's species."""
        return self.is_gate or self.is_permeable

    def is_present(self, time: float) -> bool:
        """Whether the wall is present at a time."""
        return not any(opens <= time < closes for opens, closes in self.absences)


def number_walls(scene: Scene) -> list[NumberedWall]:
    """Return all walls of a scene in the order of their numbers."""
    walls = []
    for name, ends, side in zip(SIDES, side_ends(scene.box.size), scene.box.sides, strict=True):
        action = side if isinstance(side, str) else side.action
        action = next((piston.action for piston in scene.piston if piston.wall == name), action)
        walls.append(NumberedWall(name, *ends, action))
    for k, wall in enumerate(scene.walls, FIRST_SEGMENT):
        name = label = wall.name or f"wall {k}"
        if wall.piece is not None and wall.name:
            name = f"{wall.name} {wall.piece}"
        # The labels of the many short walls of a solid or a polygonal line would overlap in a picture.
        unlabelled = wall.piece not in (None, 0) if wall.name else wall.solid or wall.piece is not None
        label = "" if unlabelled else label
        label += f" {ARROWS[wall.permeable_from]}" if label and wall.permeable_from else ""
        body = wall.start, wall.end, wall.action, wall.absences, wall.radius
        walls.append(NumberedWall(name, *body, wall.is_permeable, label, wall.arc, isinstance(wall, InnerPiston)))
    return walls


def walls_inside(scene: Scene) -> list[NumberedWall]:
    """Return the walls inside the box that do not move, in the order of their numbers."""
    return [wall for wall in number_walls(scene)[FIRST_SEGMENT:] if not wall.moves]
