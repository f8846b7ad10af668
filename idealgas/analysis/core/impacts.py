"""Tally of what discs do to one another and to the walls: virials, impulses and numbers of collisions."""

from typing import Any

import numpy as np

from idealgas._jit import njit
from idealgas.analysis.core.stream import block_at
from idealgas.gas.state import Gas
from idealgas.physics.periodic import nearest_image
from idealgas.sides import SIDES

X, Y, VX, VY = range(4)  # columns of a track: the disc at its last event


class Impacts:
    """Sums over collisions and wall hits per block.

    pair_virial: (B,), Σ r_ij·Δp_ij, by nearest images. wall_virial: (B,), -Σ r·Δp of discs that hit walls, r from the
    middle of the box. collisions: (B, S, S), upper triangle. impulse: (B, W, 2), momentum given to the walls.
    hits: (B, W).
    """

    columns = ("time", "disc", "partner", "position", "velocity")

    def __init__(self, walls: int = len(SIDES), periodic: tuple[bool, bool] = (False, False)) -> None:
        """walls: W, the sides of the box first. periodic: which axes are periodic."""
        self.walls, self.periodic = walls, periodic

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        blocks, species = len(edges) - 1, len(gas.species_names)
        self.edges = edges
        self.pair_virial = np.zeros(blocks)
        self.wall_virial = np.zeros(blocks)
        self.collisions = np.zeros((blocks, species, species), np.int64)
        self.impulse = np.zeros((blocks, self.walls, 2))
        self.hits = np.zeros((blocks, self.walls), np.int64)
        self._middle = np.array(gas.box) / 2
        self._box = gas.box
        self._species, self._mass = gas.species, gas.mass
        self._tracks = np.column_stack((gas.position, gas.velocity))
        self._block = 0

    def add(self, rows: Any) -> None:
        self._block = _add_impacts(
            rows.time, rows.disc, rows.partner, rows.position, rows.velocity,
            self._middle, self._box, self.periodic, self._species, self._mass, self._tracks, self.edges, self._block,
            self.pair_virial, self.wall_virial, self.collisions, self.impulse, self.hits,
        )  # fmt: skip

    def finish(self) -> None:
        """Flights add nothing."""


@njit
def _add_impacts(
    time, disc, partner, position, velocity, middle, box, periodic, species, mass, tracks, edges, block,
    pair_virial, wall_virial, collisions, impulse, hits,
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
        if partner[row] < 0:
            wall = -1 - partner[row]
            hits[block, wall] += 1
            impulse[block, wall, 0] -= px
            impulse[block, wall, 1] -= py
            wall_virial[block] -= (x - middle[0]) * px + (y - middle[1]) * py
        elif disc[row] > partner[row]:  # second row of a pair: the partner's track is at the contact too
            j = np.uintp(partner[row])
            apart_x = nearest_image(x - tracks[j][X], box[0], periodic[0])
            apart_y = nearest_image(y - tracks[j][Y], box[1], periodic[1])
            pair_virial[block] += apart_x * px + apart_y * py
            collisions[block, min(species[i], species[j]), max(species[i], species[j])] += 1
    return block
