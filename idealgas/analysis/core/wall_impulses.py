"""Momentum that discs give to walls, wall by wall and face by face, in blocks of time.

What a disc gives to a wall is the change of its momentum at the hit; gravity, which changes it between two events, is
taken out. Nothing has to be in equilibrium for that.
"""

from typing import Any

import numpy as np

from idealgas.analysis.core.stream import block_at
from idealgas.events import BATH, Kind
from idealgas.jit import njit
from idealgas.log import Log
from idealgas.physics.motion import velocity_after
from idealgas.sides import FIRST_SEGMENT, OUTWARD
from idealgas.state import Gas

T, VX, VY = range(3)  # columns of a track: time of the disc's last event, velocity after it

WALL_END = int(Kind.WALL_END)


class WallImpulses:
    """Momentum given to each of W walls in each of B blocks of time, mass·length/time.

    normals: (W, 2), unit normals of the first face of each wall; that of a side of the box points into the box.
    faces: (B, W, 2, 2), momentum given to the first and to the second face by discs that touch the body of the wall,
    pressed on it and along it; the direction along a wall is its first normal turned by -90°, for a segment from its
    start to its end. given: (B, W, 2),
    momentum along x and y, with that of discs that touch the ends of the wall. hits: (B, W), numbers of hits.
    """

    columns = ("time", "disc", "partner", "kind", "velocity")

    def __init__(self, log: Log) -> None:
        """Take the walls and the gravity of a log."""
        along = np.array([np.subtract(wall.end, wall.start) for wall in log.walls[FIRST_SEGMENT:]]).reshape(-1, 2)
        along /= np.hypot(*along.T)[:, None]
        self.normals = np.concatenate((-np.array(OUTWARD), np.column_stack((-along[:, 1], along[:, 0]))))
        self.gravity = log.gravity

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the state of the discs at time edges[0]; edges: (B + 1,), times between the blocks."""
        self.edges = edges
        shape = (len(edges) - 1, len(self.normals))
        self.faces, self.given = np.zeros((*shape, 2, 2)), np.zeros((*shape, 2))
        self.hits = np.zeros(shape, np.int64)
        self._mass = gas.mass
        self._tracks = np.column_stack((np.full(len(gas), edges[0]), gas.velocity))
        self._block = 0

    def add(self, rows: Any) -> None:
        """Add the next event rows of the log."""
        self._block = _add_impulses(
            rows.time, rows.disc, rows.partner, rows.kind, rows.velocity, self.gravity, self._mass, self._tracks,
            self.normals, self.edges, self._block, self.faces, self.given, self.hits,
        )  # fmt: skip

    def finish(self) -> None:
        """Do nothing: flights between events add nothing to these sums."""


@njit
def _add_impulses(
    time, disc, partner, kind, velocity, gravity, mass, tracks, normals, edges, block, faces, given, hits
):  # fmt: skip
    for row in range(time.shape[0]):
        i = np.uintp(disc[row])
        now = time[row]
        block = block_at(edges, block, now)
        track = tracks[i]
        if partner[row] < 0 and partner[row] != BATH:
            wall = -1 - partner[row]
            since = now - track[T]
            px = mass[i] * (velocity_after(track[VX], gravity[0], since) - velocity[row, 0])
            py = mass[i] * (velocity_after(track[VY], gravity[1], since) - velocity[row, 1])
            hits[block, wall] += 1
            given[block, wall, 0] += px
            given[block, wall, 1] += py
            if kind[row] != WALL_END:
                nx, ny = normals[wall, 0], normals[wall, 1]
                push = px * nx + py * ny
                face = 0 if push <= 0.0 else 1  # a disc on the side to which the normal points pushes against it
                faces[block, wall, face, 0] += abs(push)
                faces[block, wall, face, 1] += px * ny - py * nx
        track[T] = now
        track[VX] = velocity[row, 0]
        track[VY] = velocity[row, 1]
    return block
