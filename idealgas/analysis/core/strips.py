"""How discs are spread over the box: their numbers in strips along x and along y."""

from typing import Any

import numpy as np

from idealgas.jit import inline, njit
from idealgas.physics.motion import position_after
from idealgas.state import Gas

T, X, Y, VX, VY = range(5)  # columns of a track: time of the disc's last event, position and velocity after it


class Strips:
    """Numbers of discs of each species in strips of the box at the end of each block of time.

    discs: (B, S, 2, strips), for B blocks, S species, x and y.
    """

    columns = ("time", "disc", "position", "velocity")

    def __init__(
        self, strips: int, gravity: tuple[float, float] = (0.0, 0.0), periodic: tuple[bool, bool] = (False, False)
    ) -> None:
        """Take the number of strips along each axis, the acceleration in length/time², and which axes are periodic."""
        self.strips, self.gravity, self.periodic = strips, gravity, periodic

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the state of the discs at time edges[0]; edges: (B + 1,), times between the blocks."""
        self.edges = edges
        self.discs = np.zeros((len(edges) - 1, len(gas.species_names), 2, self.strips))
        self._per_length = self.strips / np.array(gas.box)
        self._species = gas.species
        self._tracks = np.column_stack((np.full(len(gas), edges[0]), gas.position, gas.velocity))
        self._block = 0

    def add(self, rows: Any) -> None:
        """Add the next event rows of the log."""
        self._block = _follow(
            rows.time, rows.disc, rows.position, rows.velocity, self.gravity, self.periodic, self._per_length,
            self._species, self._tracks, self.edges, self._block, self.discs,
        )  # fmt: skip

    def finish(self) -> None:
        """Count the discs at the ends of the blocks that are left, up to time edges[-1]."""
        _count_to(
            np.inf, self.gravity, self.periodic, self._per_length, self._species, self._tracks, self.edges,
            self._block, self.discs,
        )  # fmt: skip


@inline
def _count(gravity, periodic, per_length, species, tracks, now, discs):
    strips = discs.shape[2]
    for i in range(tracks.shape[0]):
        track = tracks[i]
        for axis in range(2):
            place = position_after(track[X + axis], track[VX + axis], gravity[axis], now - track[T]) * per_length[axis]
            if periodic[axis]:
                place -= strips * np.floor(place / strips)
            discs[species[i], axis, np.int64(min(max(place, 0.0), strips - 1))] += 1.0


@njit
def _count_to(time, gravity, periodic, per_length, species, tracks, edges, block, discs):
    """Count the discs at the end of each block, from a given one on, that ends before a time; return the next block."""
    while block < discs.shape[0] and time > edges[block + 1]:
        _count(gravity, periodic, per_length, species, tracks, edges[block + 1], discs[block])
        block += 1
    return block


@njit
def _follow(time, disc, position, velocity, gravity, periodic, per_length, species, tracks, edges, block, discs):
    for row in range(time.shape[0]):
        if time[row] > edges[block + 1]:
            block = _count_to(time[row], gravity, periodic, per_length, species, tracks, edges, block, discs)
        track = tracks[np.uintp(disc[row])]
        track[T] = time[row]
        for axis in range(2):
            track[X + axis] = position[row, axis]
            track[VX + axis] = velocity[row, axis]
    return block
