"""Triangular lattices that go on through the periodic sides of a box, and how much the box strains them."""

from __future__ import annotations

import math
from dataclasses import dataclass

UNSTRAINED = math.sqrt(3) / 2
"""Distance of rows over distance of neighbours in a row, in a lattice without strain."""


@dataclass(frozen=True)
class TriangularLattice:
    """Triangular lattice in a periodic box; every other row is shifted by half a spacing, so their number is even.

    size: width and height of the box, length. axis: along which the rows lie, 0 for x or 1 for y. columns: sites in a
    row. rows: number of rows.
    """

    size: tuple[float, float]
    axis: int
    columns: int
    rows: int

    @property
    def spacing(self) -> float:
        """Distance of neighbours in a row, length."""
        return self.size[self.axis] / self.columns

    @property
    def height(self) -> float:
        """Distance of neighbouring rows, length."""
        return self.size[1 - self.axis] / self.rows

    @property
    def strain(self) -> float:
        """Part by which the distance of rows is larger than in a lattice of equal sides; negative if it is smaller."""
        return self.height / (UNSTRAINED * self.spacing) - 1

    @property
    def nearest(self) -> float:
        """Smallest distance of two sites, length."""
        return min(self.spacing, math.hypot(self.spacing / 2, self.height))

    @property
    def unstrained(self) -> tuple[float, float]:
        """Width and height of the box of the same area and as many rows and columns in which there is no strain."""
        along = math.sqrt(self.size[0] * self.size[1] * self.columns / (UNSTRAINED * self.rows))
        sides = along, UNSTRAINED * along * self.rows / self.columns
        return sides if self.axis == 0 else sides[::-1]


def triangular_lattice(number: int, size: tuple[float, float]) -> TriangularLattice | None:
    """Lattice with so many sites in a periodic box that is strained least; None if the number is odd.

    size: width and height of the box, length.
    """
    lattices = [
        TriangularLattice(size, axis, number // rows, rows)
        for rows in range(2, number + 1, 2)
        for axis in (0, 1)
        if number % rows == 0
    ]
    return min(lattices, key=lambda one: abs(math.log1p(one.strain)), default=None)
