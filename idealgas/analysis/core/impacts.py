"""Sums over collisions and wall hits: virials, momentum given to the walls, and numbers of events."""

from typing import Any

import numpy as np

from idealgas.analysis.core.stream import block_at
from idealgas.events import BATH
from idealgas.jit import njit
from idealgas.physics.periodic import nearest_image
from idealgas.sides import SIDES
from idealgas.state import Gas

X, Y, VX, VY = range(4)  # columns of a track: position and velocity of a disc after its last event


class Impacts:
    """Sums over collisions and wall hits in each of B blocks of time, for S species and W walls.

    pair_virial: (B,), Σ r_ij·Δp_ij over pair collisions with the minimum image of r_ij, energy·time.
    wall_virial: (B,), -Σ r·Δp over wall hits with r from the centre of the box along axes that are not periodic,
    energy·time. inner_virial: (B,), Σ r·Δp over all other events along the same axes, energy·time.
    passed_on: (B, 4), momentum that all events but its own hits pass on towards each side of the box, see `add`,
    mass·length/time.
    collisions: (B, S, S), numbers of pair collisions; only the upper triangle is filled.
    impulse: (B, W, 2), momentum given to each wall, mass·length/time. hits: (B, W), numbers of hits of each wall.
    """

    columns = ("time", "disc", "partner", "position", "velocity")

    def __init__(self, walls: int = len(SIDES), periodic: tuple[bool, bool] = (False, False)) -> None:
        """Take the number of walls, in which the sides of the box come first, and whether x and y are periodic."""
        self.walls, self.periodic = walls, periodic

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the state of the discs at time edges[0]; edges: (B + 1,), times between the blocks."""
        blocks, species = len(edges) - 1, len(gas.species_names)
        self.edges = edges
        self.pair_virial = np.zeros(blocks)
        self.wall_virial = np.zeros(blocks)
        self.inner_virial = np.zeros(blocks)
        self.passed_on = np.zeros((blocks, len(SIDES)))
        self.collisions = np.zeros((blocks, species, species), np.int64)
        self.impulse = np.zeros((blocks, self.walls, 2))
        self.hits = np.zeros((blocks, self.walls), np.int64)
        self._middle = np.array(gas.box) / 2
        self._box = gas.box
        self._species, self._mass, self._radius = gas.species, gas.mass, gas.radius
        self._tracks = np.column_stack((gas.position, gas.velocity))
        self._block = 0

    def add(self, rows: Any) -> None:
        """Add the next event rows of the log.

        Momentum counts for a side of the box in proportion to how near the disc is to it: by 0 at the opposite side, by
        1 at the side itself. An event that moves momentum from one disc to another passes some of it on towards a side.
        """
        self._block = _add_impacts(
            rows.time, rows.disc, rows.partner, rows.position, rows.velocity, self._middle, self._box, self.periodic,
            self._species, self._mass, self._radius, self._tracks, self.edges, self._block, self.pair_virial,
            self.wall_virial, self.inner_virial, self.passed_on, self.collisions, self.impulse, self.hits,
        )  # fmt: skip

    def finish(self) -> None:
        """Do nothing: flights between events add nothing to these sums."""


@njit
def _add_impacts(
    time, disc, partner, position, velocity, middle, box, periodic, species, mass, radius, tracks, edges, block,
    pair_virial, wall_virial, inner_virial, passed_on, collisions, impulse, hits,
):  # fmt: skip
    for row in range(time.shape[0]):
        i = np.uintp(disc[row])
        x, y = position[row, 0], position[row, 1]
        block = block_at(edges, block, time[row])
        track = tracks[i]
        px = mass[i] * (velocity[row, 0] - track[VX])
        py = mass[i] * (velocity[row, 1] - track[VY])
        track[X] = x
        track[Y] = y
        track[VX] = velocity[row, 0]
        track[VY] = velocity[row, 1]
        virial = 0.0
        for axis in range(2):
            if not periodic[axis]:
                given = px if axis == 0 else py
                place = position[row, axis]
                virial += (place - middle[axis]) * given
                near = (place - radius[i]) / (box[axis] - 2.0 * radius[i])
                if partner[row] != -1 - 2 * axis:
                    passed_on[block, 2 * axis] -= (1.0 - near) * given
                if partner[row] != -2 - 2 * axis:
                    passed_on[block, 2 * axis + 1] += near * given
        if partner[row] == BATH:
            inner_virial[block] += virial
            continue
        if partner[row] < 0:
            wall = -1 - partner[row]
            hits[block, wall] += 1
            impulse[block, wall, 0] -= px
            impulse[block, wall, 1] -= py
            wall_virial[block] -= virial
            continue
        inner_virial[block] += virial
        if disc[row] > partner[row]:  # second row of a collision: now both tracks are at the contact
            j = np.uintp(partner[row])
            apart_x = nearest_image(x - tracks[j][X], box[0], periodic[0])
            apart_y = nearest_image(y - tracks[j][Y], box[1], periodic[1])
            pair_virial[block] += apart_x * px + apart_y * py
            collisions[block, min(species[i], species[j]), max(species[i], species[j])] += 1
    return block
