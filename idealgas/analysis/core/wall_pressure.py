"""Pressure on every wall and face in blocks of time: momentum that discs give to it, per time and exposed length.

This is what a gauge in the wall would show. It needs no equilibrium and no theory. Walls act on the centres of the
discs one radius inside the box; the length is that of the wall itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from idealgas.analysis.core.impacts import WallImpulses
from idealgas.analysis.core.moving_wall import moving_wall
from idealgas.analysis.core.samples import SampledWalls
from idealgas.analysis.core.stream import Tally
from idealgas.columns import FIRST_SEGMENT, SIDES, axis_of
from idealgas.log import Log
from idealgas.scene.walls import number_walls


@dataclass(frozen=True)
class Face:
    """One face of a wall that discs can hit, with what they gave it in each of B blocks of time.

    name: of the wall, and for a wall segment of the direction in which the face looks. wall: number of the wall. push,
    along: (B,), momentum pressed on the face and given along it, mass·length/time. exposed: (B,), length of the face
    times the time that it was there, length·time. hits: number of hits of the wall.
    """

    name: str
    wall: int
    push: np.ndarray
    along: np.ndarray
    exposed: np.ndarray
    hits: int


def wall_name(wall: int, name: str) -> str:
    """Name of a wall by its number and its own name, for tables: a side of the box is called a wall."""
    return f"{name} wall" if wall < FIRST_SEGMENT else name


class WallGauge:
    """Pressure on all walls of a log: the tallies that `stream` has to fill, and what follows from them.

    impulses: momentum given to walls. moving: depth of the room below a piston; None without one.
    """

    impulses: WallImpulses | SampledWalls

    def __init__(self, log: Log, sampled: SampledWalls | None = None) -> None:
        """Take the walls of a log; sampled: what they were given, if it does not come from events."""
        self._log = log
        self.impulses = sampled or WallImpulses(log)
        self.moving = moving_wall(log)

    @property
    def tallies(self) -> list[Tally]:
        """Tallies to fill from the events of the log."""
        moving: list[Tally] = [self.moving] if self.moving else []
        impulses: list[Tally] = [self.impulses] if isinstance(self.impulses, WallImpulses) else []
        return [*impulses, *moving]

    def area(self, edges: np.ndarray) -> np.ndarray:
        """Area (B,) that the gas has in each block of time: the box, or the room that a piston leaves, length²."""
        if self.moving is None:
            return np.full(len(edges) - 1, self._log.discs.area)
        return self.moving.depth * self.moving.across

    def faces(self, edges: np.ndarray) -> list[Face]:
        """Faces of sides that are not periodic and of wall segments; edges: (B + 1,), times between the blocks."""
        found = []
        for k, wall in enumerate(number_walls(self._log.scene)):
            if k < FIRST_SEGMENT and self._log.periodic[axis_of(k)]:
                continue
            exposed = self._exposed(k, wall.start, wall.end, wall.absence, edges)
            if not exposed.any():
                continue
            names = [wall_name(k, wall.name)]
            if k >= FIRST_SEGMENT:
                names = [f"{wall.name}, {name}" for name in self._looks(k)]
            for face, name in enumerate(names):
                push, along = self.impulses.faces[:, k, face].T
                found.append(Face(name, k, push, along, exposed, int(self.impulses.hits[:, k].sum())))
        return found

    def _looks(self, wall: int) -> tuple[str, str]:
        """Directions in which the two faces of a wall segment look."""
        x, y = self.impulses.normals[wall]
        names = ("right", "left") if abs(x) >= abs(y) else ("up", "down")
        return names if (x if abs(x) >= abs(y) else y) > 0 else (names[1], names[0])

    def _exposed(
        self,
        wall: int,
        start: Sequence[float],
        end: Sequence[float],
        absence: tuple[float, float],
        edges: np.ndarray,
    ) -> np.ndarray:
        """Length of a wall times the time that it is there, in each block; of a side next to a piston, in its room."""
        width = np.diff(edges)
        if wall < len(SIDES) and self.moving is not None and axis_of(wall) != self.moving.axis:
            return self.moving.depth * width
        opens, closes = absence
        absent = np.clip(np.minimum(edges[1:], closes) - np.maximum(edges[:-1], opens), 0.0, None)
        return float(np.hypot(*np.subtract(end, start))) * (width - absent)
