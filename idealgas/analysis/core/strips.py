"""How discs are spread over the box: time that they spend in strips along x and along y."""

from typing import Any

import numpy as np

from idealgas._jit import inline, njit
from idealgas.analysis.core.stream import block_at, block_back
from idealgas.gas.state import Gas
from idealgas.physics.motion import position_after

T, X, Y, VX, VY = range(5)  # columns of a track: time of the disc's last event, position and velocity after it


class Strips:
    """Time that discs of each species spend in strips of the box, in each block of time.

    occupied: (B, S, 2, strips), time for B blocks, S species, x and y. A flight, or its part in a block, counts whole
    for the strip in which it has its middle: this shows where the gas is, not how dense exactly.
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
        self.occupied = np.zeros((len(edges) - 1, len(gas.species_names), 2, self.strips))
        self._per_length = self.strips / np.array(gas.box)
        self._species = gas.species
        self._tracks = np.column_stack((np.full(len(gas), edges[0]), gas.position, gas.velocity))
        self._block = 0

    def add(self, rows: Any) -> None:
        """Add the next event rows of the log."""
        self._block = _add_strips(
            rows.time, rows.disc, rows.position, rows.velocity, self.gravity, self.periodic, self._per_length,
            self._species, self._tracks, self.edges, self._block, self.occupied,
        )  # fmt: skip

    def finish(self) -> None:
        """Add the last part of the flight of every disc, up to time edges[-1]."""
        _finish_strips(
            self.gravity, self.periodic, self._per_length, self._species, self._tracks, self.edges, self.occupied
        )


@inline
def _spend_in_strips(track, gravity, periodic, per_length, species, until, edges, block, occupied):
    strips = occupied.shape[3]
    since = track[T]
    k = block_back(edges, block, since)
    while True:
        stop = until if k == block else edges[k + 1]
        middle = 0.5 * (since + stop) - track[T]
        for axis in range(2):
            place = position_after(track[X + axis], track[VX + axis], gravity[axis], middle) * per_length[axis]
            if periodic[axis]:
                place -= strips * np.floor(place / strips)
            occupied[k, species, axis, np.int64(min(max(place, 0.0), strips - 1))] += stop - since
        if k == block:
            break
        since = stop
        k += 1


@njit
def _add_strips(time, disc, position, velocity, gravity, periodic, per_length, species, tracks, edges, block, occupied):
    for row in range(time.shape[0]):
        i = np.uintp(disc[row])
        block = block_at(edges, block, time[row])
        track = tracks[i]
        _spend_in_strips(track, gravity, periodic, per_length, species[i], time[row], edges, block, occupied)
        track[T] = time[row]
        for axis in range(2):
            track[X + axis] = position[row, axis]
            track[VX + axis] = velocity[row, axis]
    return block


@njit
def _finish_strips(gravity, periodic, per_length, species, tracks, edges, occupied):
    for i in range(tracks.shape[0]):
        _spend_in_strips(
            tracks[i], gravity, periodic, per_length, species[i], edges[-1], edges, edges.shape[0] - 2, occupied
        )
