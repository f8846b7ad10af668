"""Discs at one instant."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Gas:
    """Discs at one instant, in order of id.

    position, velocity: (N, 2) f8, length and length/time. radius, mass: (N,) f8. species: (N,) u2, index into
    species_names. box: (Lx, Ly); the corner at the lower left is the origin.
    """

    box: tuple[float, float]
    position: np.ndarray
    velocity: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    species: np.ndarray
    species_names: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.mass)

    @property
    def area(self) -> float:
        """Box area."""
        return self.box[0] * self.box[1]

    @property
    def packing_fraction(self) -> float:
        """Share of the box covered by discs."""
        return float(np.pi * (self.radius**2).sum() / self.area)

    @property
    def kinetic_energy(self) -> float:
        """Sum of m v²/2."""
        return float((0.5 * self.mass * (self.velocity**2).sum(axis=1)).sum())

    @property
    def temperature(self) -> float:
        """Kinetic temperature E/N (two degrees of freedom a disc, k_B = 1)."""
        return self.kinetic_energy / len(self)
