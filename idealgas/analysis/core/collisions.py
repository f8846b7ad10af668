"""Collision rates and mean free paths of each species of discs, measured and by kinetic theory."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from idealgas.analysis.core.composition import Composition
from idealgas.analysis.core.equilibrium import Ensemble
from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.impacts import Impacts
from idealgas.analysis.core.statistics import Estimate, estimate, mean, ratio
from idealgas.analysis.core.window import Window
from idealgas.analysis.theory import hard_discs


@dataclass(frozen=True)
class CollisionRate:
    """Collision rate of one disc of `species` with all discs of the species `other`, in 1/time."""

    species: str
    other: str
    rate: Estimate

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        return {"species": self.species, "other": self.other, "rate": self.rate.as_dict()}


@dataclass(frozen=True)
class FreePath:
    """Mean free path, mean free time and mean speed of the discs of one species.

    path: mean length of path between successive collisions of a disc with other discs, length. time: mean time between
    them, time. speed: mean speed of a disc, length/time.
    """

    species: str
    path: Estimate
    time: Estimate
    speed: Estimate

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        values = {"path": self.path.as_dict(), "time": self.time.as_dict(), "speed": self.speed.as_dict()}
        return {"species": self.species, **values}


def expected_rates(
    discs: Composition,
    box: tuple[float, float],
    equilibrium: Ensemble,
    periodic: tuple[bool, bool] = (False, False),
    has_positions: bool = True,
) -> np.ndarray:
    """Collision rates Γ_ij of one disc of species i with the discs of species j by theory, in 1/time.

    The product of the contacts per relative speed, from which the pressure follows as well
    (`hard_discs.box_compressibility`), and of the mean relative speed, which is a little larger at fixed total energy
    than by Maxwell-Boltzmann's law.

    Args:
        discs: the S species of the gas.
        box: width and height of the box, length.
        equilibrium: the ensemble that the gas belongs to.
        periodic: whether the box is periodic along x and along y.
        has_positions: False for a method whose discs have no positions.

    Returns:
        Rates of shape (S, S); not a number above the freezing density, where the theory of the fluid ends.
    """
    if has_positions:
        contacts = hard_discs.box_contacts(discs.radius, discs.number, box, periodic)
    else:
        contacts = hard_discs.contacts_without_positions(discs.radius, discs.number, box)
    return contacts * hard_discs.mean_relative_speeds(equilibrium.temperature, discs.mass, equilibrium.dof)


def collision_rates(
    discs: Composition, expected: np.ndarray, window: Window, impacts: Impacts
) -> tuple[CollisionRate, ...]:
    """Measured collision rates of all ordered pairs of species, in 1/time.

    expected: (S, S) rates by theory, from `expected_rates`.
    """
    counts = window.of(impacts.collisions)

    def rate(i: int, j: int) -> Estimate:
        discs_per_event = 2 if i == j else 1
        series = discs_per_event * counts[:, min(i, j), max(i, j)] / discs.number[i]
        return mean(series, theory=_known(expected[i, j]))

    species = range(len(discs.name))
    return tuple(CollisionRate(discs.name[i], discs.name[j], rate(i, j)) for i in species for j in species)


def free_paths(
    discs: Composition, expected: np.ndarray, equilibrium: Ensemble, window: Window, moments: Moments, impacts: Impacts
) -> tuple[FreePath, ...]:
    """Mean free path λ = ⟨v⟩/Γ, mean free time 1/Γ and mean speed ⟨v⟩ of each species.

    expected: (S, S) collision rates by theory in 1/time, from `expected_rates`.
    """
    counts = window.of(impacts.collisions)
    paths = []
    for i, (name, mass, number) in enumerate(zip(discs.name, discs.mass, discs.number, strict=True)):
        own = (counts[:, i, :] + counts[:, :, i]).sum(axis=1) / number  # a collision of two like discs counts for both
        speeds = window.of(moments.flights)[:, i, 0] / number
        speed = hard_discs.mean_speed(equilibrium.of_species[i], mass, equilibrium.dof)
        free_time = np.inf if expected[i].sum() == 0 else 1 / expected[i].sum()
        paths.append(
            FreePath(
                name,
                path=ratio(speeds, own, theory=_known(speed * free_time)),
                time=estimate(lambda rate: 1 / rate, own, theory=_known(free_time)),
                speed=mean(speeds, theory=speed),
            )
        )
    return tuple(paths)


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
