"""Triangular lattices in periodic boxes, with the strain that is needed to fit them to the box."""

from __future__ import annotations

import math
from dataclasses import dataclass

UNSTRAINED = math.sqrt(3) / 2
"""Ratio of the distance between rows to the distance between neighbours in a row, in a lattice without strain."""


@dataclass(frozen=True)
class TriangularLattice:
    """Triangular lattice in a periodic box.

    Every second row is shifted by half a spacing, so the number of rows must be even.

    Attributes:
        size: width and height of the box, length.
        axis: direction of the rows: 0 for x, 1 for y.
        columns: number of sites per row.
        rows: number of rows.
    """

    size: tuple[float, float]
    axis: int
    columns: int
    rows: int

    @property
    def spacing(self) -> float:
        """Distance between neighbours in a row, length."""
        return self.size[self.axis] / self.columns

    @property
    def height(self) -> float:
        """Distance between neighbouring rows, length."""
        return self.size[1 - self.axis] / self.rows

    @property
    def strain(self) -> float:
        """Relative deviation of the distance between rows from its value in an equilateral lattice."""
        return self.height / (UNSTRAINED * self.spacing) - 1

    @property
    def nearest(self) -> float:
        """Smallest distance between two sites, length."""
        return min(self.spacing, math.hypot(self.spacing / 2, self.height))

    @property
    def unstrained(self) -> tuple[float, float]:
        """Width and height of the box of equal area in which this lattice would have no strain, length."""
        along = math.sqrt(self.size[0] * self.size[1] * self.columns / (UNSTRAINED * self.rows))
        sides = along, UNSTRAINED * along * self.rows / self.columns
        return sides if self.axis == 0 else sides[::-1]


def triangular_lattice(number: int, size: tuple[float, float]) -> TriangularLattice | None:
    """Return the least strained triangular lattice in a periodic box; None if the number of sites is odd.

    Args:
        number: number of sites.
        size: width and height of the box, length.
    """
    lattices = [
        TriangularLattice(size, axis, number // rows, rows)
        for rows in range(2, number + 1, 2)
        for axis in (0, 1)
        if number % rows == 0
    ]
    return min(lattices, key=lambda lattice: abs(math.log1p(lattice.strain)), default=None)
