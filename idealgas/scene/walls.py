"""The walls of a scene by their numbers: 0 to 3 are the sides of the box, the segments follow."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from idealgas.scene.geometry import Point
from idealgas.scene.tables.box import SIDES
from idealgas.scene.tables.piston import Piston
from idealgas.scene.tables.thermal import ThermalSide
from idealgas.scene.tables.wall import Wall

if TYPE_CHECKING:
    from idealgas.scene.model import Scene


class NumberedWall(NamedTuple):
    """name; start, end: length; action: what it does, in words."""

    name: str
    start: Point
    end: Point
    action: str


def number_walls(scene: Scene) -> list[NumberedWall]:
    """All walls, wall k at place k."""
    width, height = scene.box.size
    ends: list[tuple[Point, Point]] = [
        ((0.0, 0.0), (0.0, height)),
        ((width, 0.0), (width, height)),
        ((0.0, 0.0), (width, 0.0)),
        ((0.0, height), (width, height)),
    ]
    walls = []
    for name, end, side in zip(SIDES, ends, scene.box.sides, strict=True):
        action = f"emits at temperature {side.thermal:g}" if isinstance(side, ThermalSide) else str(side)
        if scene.piston and scene.piston.side == name:
            action = _piston_action(scene.piston)
        walls.append(NumberedWall(name, *end, action))
    for k, wall in enumerate(scene.wall):
        walls.append(NumberedWall(wall.name or f"wall {len(SIDES) + k}", wall.start, wall.end, _action(wall)))
    return walls


def _action(wall: Wall) -> str:
    action = "reflecting" if wall.temperature is None else f"emits at temperature {wall.temperature:g}"
    opens, closes = wall.absence
    if math.isinf(opens):
        return action
    return f"{action}, open from {opens:g}" + ("" if math.isinf(closes) else f" to {closes:g}")


def _piston_action(piston: Piston) -> str:
    if piston.mass is None:
        return f"piston of velocity {piston.velocity:g}"
    return f"piston of mass {piston.mass:g} under pressure {piston.pressure:g}"
