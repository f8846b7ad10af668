"""Collisional part of the pressure tensor in strips of the box: momentum transferred along the line of centres.

A collision of hard discs transfers momentum instantaneously and is contained in the log. It contributes to each strip
in proportion to the part of the line of centres that lies in the strip: Irving & Kirkwood, J. Chem. Phys. 18, 817
(1950).
"""

from collections.abc import Iterator

import numpy as np

from idealgas.log import Flights
from idealgas.state import Gas
from idealgas.tallies.impacts import contacts
from idealgas.tallies.stream import add_to


class PassedOn:
    """Momentum that collisions transfer, in K strips along an axis.

    Attributes:
        stress: (B, K, 3), Σ Δp_x x, Σ Δp_y y and Σ Δp_t n in B blocks, where n is the component of the line of centres
            along the axis and t denotes the perpendicular direction, energy·time.
        collisions: (B,), number of collisions.
    """

    columns = ("disc", "block", "end", "kind", "partner", "end_velocity", "new_velocity", "end_position")
    cut = False

    def __init__(self, axis: int, edges: np.ndarray, periodic: tuple[bool, ...], shear: float = 0.0) -> None:
        """Set the edges (K + 1,) of the strips along an axis, whether x and y are periodic, and the shear rate."""
        self._axis, self._low, self._width, self._bins = axis, edges[0], edges[1] - edges[0], len(edges) - 1
        self._periodic, self._shear = periodic, shear

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        self._mass, self._box = gas.mass, gas.box
        self._sums, self.collisions = np.zeros((3, len(edges) - 1, self._bins)), np.zeros(len(edges) - 1)

    def add(self, flights: Flights) -> None:
        """Add the collisions at the ends of a batch of flights."""
        assert flights.end_position is not None
        second, apart = contacts(flights, self._box, self._periodic, self._shear)
        given = flights.new_velocity.take(second, axis=0) - flights.end_velocity.take(second, axis=0)
        given *= self._mass.take(flights.disc[second])[:, None]
        along = apart[:, self._axis]
        values = given[:, 0] * apart[:, 0], given[:, 1] * apart[:, 1], given[:, 1 - self._axis] * along
        place = (flights.end_position[second, self._axis] - self._low) / self._width
        add_to(self.collisions, flights.block[second], np.ones_like(along))
        row = flights.block[second] * self._bins
        for strip, share in self._shares(place, place - along / self._width):
            for sums, value in zip(self._sums, values, strict=True):
                add_to(sums, row + strip, share * value)

    def finish(self) -> None:
        """Set the attributes from the sums."""
        self.stress = np.moveaxis(self._sums, 0, 2)

    def _shares(self, start: np.ndarray, end: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield strips, and the fractions of lines from `start` to `end` that lie in them.

        The ends of the lines are measured from the first edge, in widths of a strip.
        """
        low, high = np.minimum(start, end), np.maximum(start, end)
        first, length = np.floor(low), high - low
        for k in range(int((high - first).max(initial=0.0)) + 1):
            inside = np.minimum(high, first + k + 1) - np.maximum(low, first + k)
            share = np.divide(np.maximum(inside, 0.0), length, out=np.full(len(low), float(k == 0)), where=length > 0)
            strip = (first + k).astype(np.intp)
            last = self._bins - 1
            yield strip % self._bins if self._periodic[self._axis] else np.clip(strip, 0, last), share
