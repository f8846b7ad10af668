"""State of the gas at an instant, and the random numbers from which it is drawn."""

from dataclasses import dataclass

import numpy as np

MOST_PAIRED = 32
"""Largest number of species whose pairs are counted separately; memory and time grow with the square of this number."""


@dataclass(frozen=True)
class Gas:
    """All discs at an instant, in order of id.

    Attributes:
        box: (Lx, Ly), size of the box, length; the origin is at the lower left corner.
        position: (N, 2) f8, positions, length.
        velocity: (N, 2) f8, velocities, length/time.
        radius: (N,) f8, radii, length.
        mass: (N,) f8, masses, mass.
        species: (N,) u2, index into species_names.
        species_names: name of each species.
        solid_area: area of the box that is occupied by solid walls, length².
    """

    box: tuple[float, float]
    position: np.ndarray
    velocity: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    species: np.ndarray
    species_names: tuple[str, ...]
    solid_area: float = 0.0

    def __len__(self) -> int:
        """Return the number N of discs."""
        return len(self.mass)

    @property
    def partners(self) -> tuple[str, ...]:
        """Names of the groups of partners whose collisions with a species are counted separately.

        The groups are the species, or a single group "all" if there are more than MOST_PAIRED species.
        """
        return self.species_names if len(self.species_names) <= MOST_PAIRED else ("all",)

    @property
    def partner(self) -> np.ndarray:
        """(N,), index of each disc into `partners`."""
        return self.species if len(self.species_names) <= MOST_PAIRED else np.zeros_like(self.species)

    @property
    def unlike(self) -> tuple[str, ...]:
        """Names of the species whose discs differ in radius or mass."""
        _, first, kind = np.unique(self.species, return_index=True, return_inverse=True)
        differs = (self.radius != self.radius[first][kind]) | (self.mass != self.mass[first][kind])
        return tuple(self.species_names[k] for k in np.unique(self.species[differs]))

    @property
    def area(self) -> float:
        """Area of the box without solid walls, length²."""
        return self.box[0] * self.box[1] - self.solid_area

    @property
    def packing_fraction(self) -> float:
        """Fraction of the area that is covered by discs, no unit."""
        return float(np.pi * (self.radius**2).sum() / self.area)

    @property
    def kinetic_energy(self) -> float:
        """Sum of m v²/2 over the discs, mass·length²/time²."""
        vx, vy = self.velocity.T
        return float((0.5 * self.mass * (vx**2 + vy**2)).sum())

    @property
    def temperature(self) -> float:
        """Kinetic temperature E/N, mass·length²/time², for two degrees of freedom per disc and k_B = 1."""
        return self.kinetic_energy / len(self)


def rng(seed: int, use: str) -> "np.random.Generator":
    """Return the random-number generator of a seed for one purpose, independent of the generators for other purposes.

    Args:
        seed: seed of the scene.
        use: name of the purpose.
    """
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=tuple(use.encode()))))
