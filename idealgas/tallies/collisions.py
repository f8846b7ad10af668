"""Collision rates and mean free paths of each species of discs, measured and from kinetic theory."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates
from idealgas.statistics.estimates import Estimate, estimate, mean, of_events, ratio
from idealgas.tallies.equilibration import Window
from idealgas.tallies.flights import Moments
from idealgas.tallies.impacts import Impacts
from idealgas.tallies.samples import SampledImpacts
from idealgas.theory import conserved, hard_discs
from idealgas.theory.ensemble import Composition, Ensemble, classes
from idealgas.theory.values import BoxTheory, Theory, box_theory


@dataclass(frozen=True)
class CollisionRate:
    """Collision rate of a disc of `species` with all discs of the group `other` (see `Gas.partners`), 1/time."""

    species: str
    other: str
    rate: Estimate


@dataclass(frozen=True)
class FreePath:
    """Mean free path, mean free time and mean speed of the discs of one species.

    Attributes:
        species: name of the species.
        path: mean path length between successive collisions of a disc with other discs, length.
        time: mean time between these collisions, time.
        speed: mean speed of a disc, length/time.
    """

    species: str
    path: Estimate
    time: Estimate
    speed: Estimate


class ExpectedRates(NamedTuple):
    """Theoretical collision rates Γ_ij of a disc of species i with the discs of group j, with their errors.

    Attributes:
        rate: (S, G), Γ_ij, 1/time; nan if theory is not available.
        relative_error: (S, G), relative standard error of Γ_ij.
        discs: kinds of discs, see `classes`.
        of_kinds: (2, K, K), rates between kinds of discs, 1/time, and their relative errors.
    """

    rate: np.ndarray
    relative_error: np.ndarray
    discs: Composition
    of_kinds: np.ndarray

    def between(self, i: int, j: int) -> Theory | None:
        """Return the rate Γ_ij, 1/time; None if theory is not available."""
        return self._theory(self.rate[i, j], self.relative_error[i, j] * self.rate[i, j])

    def of(self, i: int) -> Theory | None:
        """Return the rate of collisions of a disc of species i with all other discs, 1/time; None if not available."""
        return self._theory(self.rate[i].sum(), (self.relative_error[i] * self.rate[i]).sum())

    @staticmethod
    def _theory(rate: float, error: float) -> Theory | None:
        return Theory(float(rate), float(error), "kinetic theory") if np.isfinite(rate) else None


def theory_of(log: Log) -> BoxTheory:
    """Return the theory of the pressure and of the contacts between discs for the gas of a log, if it is uniform."""
    discs = classes(log.discs)
    ergodic, interacting = conserved.is_ergodic(log.scene, log.discs), log.scene.properties.interacting
    return box_theory(discs.radius, discs.number, log.box, log.periodic, ergodic=ergodic, interacting=interacting)


def expected_rates(box: tuple[float, float], equilibrium: Ensemble, theory: BoxTheory | None) -> ExpectedRates:
    """Return the theoretical collision rates Γ_ij of a disc of species i with the discs of group j, 1/time.

    A rate is the product of the collision rate at unit relative speed, which also determines the pressure, and the mean
    relative speed. The mean relative speed at fixed total energy is slightly larger than that of the Maxwell-Boltzmann
    distribution.

    Args:
        box: width and height of the box, length.
        equilibrium: ensemble of the gas.
        theory: result of `theory_of`; None for a method whose discs have no positions.
    """
    discs = equilibrium.discs
    speed = hard_discs.mean_relative_speeds(equilibrium.temperature, discs.mass, equilibrium.dof)
    if theory is None:
        contacts, error = hard_discs.contacts_without_positions(discs.radius, discs.number, box), 0 * speed
    else:
        contacts, error = theory.contacts, theory.rate_error
    rate, off = (discs.with_partners(rates) for rates in (contacts * speed, error * contacts * speed))
    with np.errstate(invalid="ignore"):
        relative = np.where(rate > 0, off / rate, 0.0) if rate.shape < speed.shape else error
    return ExpectedRates(rate, relative, discs, np.array((contacts * speed, error)))


def collision_rates(
    discs: Composition, expected: ExpectedRates, window: Window, impacts: Impacts | SampledImpacts
) -> tuple[CollisionRate, ...]:
    """Return the measured collision rates of each species with each group of discs, 1/time; empty if not recorded.

    The number of independent samples is at most the number of collisions.

    Args:
        discs: species of the gas.
        expected: theoretical rates, from `expected_rates`.
        window: window of time.
        impacts: tally with the numbers of collisions.
    """
    counts, partners = window.of(impacts.collisions), discs.partners

    def rate(i: int, j: int) -> Estimate:
        rate = mean(counts[:, i, j] / discs.number[i], theory=expected.between(i, j))
        of_pairs = 2 if partners[j] == discs.name[i] else 1  # both discs of a pair of one species count
        number = float(counts[:, i, j].sum()) * window.width / of_pairs
        return replace(rate, independent_samples=min(rate.independent_samples, number))

    species, groups = range(counts.shape[1]), range(len(partners))
    return tuple(CollisionRate(discs.name[i], partners[j], rate(i, j)) for i in species for j in groups)


def free_paths(
    discs: Composition,
    expected: ExpectedRates,
    equilibrium: Ensemble,
    window: Window,
    moments: Moments,
    impacts: Impacts,
) -> tuple[FreePath, ...]:
    """Return the mean free path λ = ⟨v⟩/Γ, mean free time 1/Γ and mean speed ⟨v⟩ of each species.

    expected: theoretical collision rates, from `expected_rates`.
    """
    counts, flights, mean_speeds = window.of(impacts.collisions), window.of(moments.flights), equilibrium.mean_speed
    paths = []
    for i, (name, number) in enumerate(zip(discs.name, discs.number, strict=True)):
        rates = counts[:, i].sum(axis=1) / number
        speeds = flights[:, i, 0] / number
        speed, collided = float(mean_speeds[i]), float(rates.sum()) * window.width * number
        rate = expected.of(i)
        free_time = rate.inverse() if rate and rate.value else None
        paths.append(
            FreePath(
                name,
                path=of_events(
                    ratio(speeds, rates, theory=free_time.times(speed) if free_time and speed else None), collided
                ),
                time=of_events(estimate(lambda rate: 1 / rate, rates, theory=free_time), collided),
                speed=mean(speeds, theory=speed or None),
            )
        )
    return tuple(paths)


def collisions_per_disc(log: Log, time: np.ndarray) -> np.ndarray:
    """Return the mean number of collisions per disc from time[0] up to each time, (K,).

    Each collision counts for both of its discs.
    """
    counts = np.zeros(len(time))
    for rows in log.chunks(("time", "partner"), log.row_at(time[0], "right"), log.row_at(time[-1], "right")):
        counts += rows.time[rows.partner >= 0].searchsorted(time, "right")
    return counts / len(log.discs)


def collision_tables(rates: Iterable[CollisionRate], paths: Iterable[FreePath]) -> list[Table]:
    """Return tables of collision rates (1/time), mean free paths (length) and mean free times (time)."""
    between = [
        (f"{entry.species}: {name}", value)
        for entry in paths
        for name, value in (("mean free path", entry.path), ("mean free time", entry.time), ("mean speed", entry.speed))
    ]
    return [
        estimates("Collisions per disc (1/time)", [(f"{r.species} with {r.other}", r.rate) for r in rates]),
        estimates("Mean free path and time (in units of length and time)", between),
    ]
