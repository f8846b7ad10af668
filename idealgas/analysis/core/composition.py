"""Composition of a gas: radius, mass and number of the discs of each species."""

from typing import NamedTuple

import numpy as np

from idealgas.state import Gas


class Composition(NamedTuple):
    """Names, radii (length), masses (mass) and numbers of discs of the S species of a gas.

    name: S names. radius, mass, number: arrays of shape (S,), one entry for each species.
    """

    name: tuple[str, ...]
    radius: np.ndarray
    mass: np.ndarray
    number: np.ndarray

    def packing_fraction(self, density: np.ndarray) -> float:
        """Packing fraction φ of a gas whose species have the number densities `density` (S,), in 1/length²."""
        return float(np.pi * (density * self.radius**2).sum())


def composition(gas: Gas) -> Composition:
    """Composition of a gas; all discs of one species have the same radius and the same mass."""
    _, first, number = np.unique(gas.species, return_index=True, return_counts=True)
    return Composition(gas.species_names, gas.radius[first], gas.mass[first], number)
