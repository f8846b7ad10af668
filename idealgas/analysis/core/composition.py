"""What a gas consists of, species by species."""

from typing import NamedTuple

import numpy as np

from idealgas.gas.state import Gas


class Composition(NamedTuple):
    """name: S names. radius, mass, number: (S,), one entry a species."""

    name: tuple[str, ...]
    radius: np.ndarray
    mass: np.ndarray
    number: np.ndarray

    def packing_fraction(self, density: np.ndarray) -> float:
        """φ of species at number densities (S,)."""
        return float(np.pi * (density * self.radius**2).sum())


def composition(gas: Gas) -> Composition:
    """The species of a gas, each of one radius and one mass."""
    _, first, number = np.unique(gas.species, return_index=True, return_counts=True)
    return Composition(gas.species_names, gas.radius[first], gas.mass[first], number)
