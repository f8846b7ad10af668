"""Diffusion of single discs, from their positions and velocities at evenly spaced instants."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from idealgas.analysis.transport.correlations import correlation, mean_square_displacement, velocity_integral
from idealgas.analysis.transport.enskog import Enskog
from idealgas.log import Log
from idealgas.statistics.estimates import Estimate, mean
from idealgas.tallies.equilibration import Window
from idealgas.tallies.stream import sample_trajectories
from idealgas.theory import hard_discs
from idealgas.theory.conserved import centre_of_mass_velocity
from idealgas.theory.ensemble import Composition, Ensemble
from idealgas.theory.values import Theory

LAGS = 200  # number of steps of the correlation functions
MOST_SEGMENTS = 64
MOST_SAMPLES = 2**21  # largest product of the numbers of discs and instants
FITTED_FROM = 0.5  # the displacement is fitted at lags from this fraction of the longest lag
LEAST_LAG = 10.0  # in mean free times; at shorter lags velocities are still correlated, and D is too small
LEAST_MEMORIES = 4.0  # in velocity correlation times; for discs whose velocities are correlated for longer
FREE_SHARE = 0.05  # largest displacement that walls hardly affect, relative to the free length between them
FALL = 0.1  # largest relative decrease in D from the lags just before the plateau to the plateau
FEWEST_LAGS = 4  # smallest number of steps with which D can be measured
SURE = 0.9999  # confidence level at which a decrease in D is accepted


@dataclass(frozen=True)
class Diffusion:
    """Velocity correlation and diffusion of one species at L lags.

    The last three attributes are None if D has no plateau, either because walls reflect the discs before they diffuse,
    or because D decreases with the lag.

    Attributes:
        species: name of the species.
        lag: (L,), lags, time.
        correlation: (L,), velocity correlation ⟨v(0)·v(t)⟩/⟨v²⟩ (no unit).
        correlation_error: (L,), standard error of `correlation`.
        displacement: (L,), mean square displacement, length².
        displacement_error: (L,), standard error of `displacement`.
        tail: (L,), theoretical velocity correlation at long times; None if Enskog's coefficients are not available.
        running: (L,), a quarter of the slope of the mean square displacement, length²/time.
        running_error: (L,), standard error of `running`.
        plateau: first and last lags of the range in which D is measured.
        coefficient: diffusion coefficient D, a quarter of the slope of the mean square displacement in this range,
            length²/time; compared with Enskog's value.
        velocity_correlation_time: integral of the velocity correlation up to a lag, averaged over the plateau, time;
            its theoretical value is mD/T.
    """

    species: str
    lag: np.ndarray
    correlation: np.ndarray
    correlation_error: np.ndarray
    displacement: np.ndarray
    displacement_error: np.ndarray
    tail: np.ndarray | None
    running: np.ndarray
    running_error: np.ndarray
    plateau: tuple[float, float] | None
    coefficient: Estimate | None
    velocity_correlation_time: Estimate | None


class LagLimits(NamedTuple):
    """Limits on the lags and displacements at which discs of a species diffuse.

    Attributes:
        rate: collision rate of a disc, 1/time.
        needed: smallest lag at which D can be measured, time.
        friction_d: estimate of D from the friction due to these collisions, length²/time.
        ways: lengths over which a disc can move freely between opposite walls, length.
    """

    rate: float
    needed: float
    friction_d: float
    ways: tuple[float, ...]

    @property
    def reach(self) -> float:
        """Largest displacement that walls hardly affect, length."""
        return FREE_SHARE * min(self.ways, default=math.inf)

    def within(self, displacement: np.ndarray) -> int:
        """Return the index of the last lag at which a mean square displacement (L,) is at most `reach` squared."""
        return int(np.flatnonzero(displacement <= self.reach**2)[-1])

    def are_walls(self, lag: np.ndarray, displacement: np.ndarray) -> bool:
        """Return whether walls reflect the discs before they diffuse."""
        last = self.within(displacement)
        return last < len(lag) - 1 and (lag[last] < self.needed or last < FEWEST_LAGS)

    def lost(self, displacement: float) -> float:
        """Return the relative decrease in D due to walls at a mean square displacement 4Dt.

        For diffusion between two walls a distance a apart, half the slope of ⟨Δx²⟩ is (8D/π²) Σ exp(-n²π²Dt/a²)/n²,
        summed over odd n. At short times this is D [1 - (4/√π) √(Dt)/a]. D is the mean over both axes, so the walls
        across one axis contribute half of this decrease.
        """
        return sum(math.sqrt(displacement / math.pi) / way for way in self.ways)


def diffusion_limits(log: Log, discs: Composition, collisions: np.ndarray, equilibrium: Ensemble) -> list[LagLimits]:
    """Return, for each species, the limits of the lags at which its diffusion can be measured.

    The velocity of a disc of species i decays at the rate Σ_j 2 m_j/(m_i + m_j) Γ_ij. If there are so many species that
    the rates are not known for every pair, m_j is the mean mass of all discs.

    Args:
        log: log of the gas.
        discs: species of the gas.
        collisions: (B, S, G), total rate of the collisions of all discs of a species with discs of a group, 1/time.
        equilibrium: ensemble of the gas.
    """
    diffusions = []
    each = collisions.mean(axis=0) / discs.number[:, None]
    masses = discs.mass if each.shape[1] == len(discs.mass) else discs.number @ discs.mass / discs.number.sum()
    for rate, mass, radius in zip(each, discs.mass, discs.radius, strict=True):
        friction = float((rate * (2 * masses / (mass + masses))).sum())
        whole = float(rate.sum())
        needed = max(LEAST_LAG / whole, LEAST_MEMORIES / friction) if whole else math.inf
        friction_d = equilibrium.temperature / mass / friction if whole else math.inf
        sides = [side for side, is_periodic in zip(log.box, log.periodic, strict=True) if not is_periodic]
        diffusions.append(LagLimits(whole, needed, friction_d, tuple(side - 2 * float(radius) for side in sides)))
    return diffusions


def diffusion(
    log: Log,
    discs: Composition,
    window: Window,
    longest: float,
    limits: Sequence[LagLimits],
    expected: tuple[Enskog | None, Sequence[Theory | None], Ensemble],
) -> tuple[Diffusion, ...]:
    """Return the diffusion of each species, up to the longest lag or, between walls, up to the lag that they allow.

    Args:
        log: log of the gas.
        discs: species of the gas.
        window: window of time.
        longest: longest lag, time.
        limits: limits for each species.
        expected: Enskog's coefficients, the theoretical D of each species, and the ensemble.
    """
    longest = min(longest, max(max(limit.needed, limit.reach**2 / (4 * limit.friction_d)) for limit in limits))
    segments = min(int(window.duration / longest), MOST_SEGMENTS)
    lag = np.linspace(0.0, longest, LAGS + 1)
    starts = np.linspace(window.start, window.end - longest, segments)
    times = (starts[:, None] + lag).ravel()
    times = np.minimum(np.maximum.accumulate(times), window.end)
    most = max(MOST_SAMPLES // len(times) // len(discs.name), 1)
    members = [np.flatnonzero(log.discs.species == s) for s in range(len(discs.name))]
    chosen = [ids[:: -(-len(ids) // most)] for ids in members]
    places, velocities = sample_trajectories(log, times, np.concatenate(chosen))
    shape = (segments, len(lag), -1, 2)
    places, velocities = (
        places.reshape(shape),
        velocities.reshape(shape) - centre_of_mass_velocity(log.scene, log.discs),
    )
    places = places - lag[:, None, None] * centre_of_mass_velocity(log.scene, log.discs)
    cuts = np.cumsum([len(ids) for ids in chosen])[:-1]
    parts = zip(discs.name, np.split(places, cuts, axis=2), np.split(velocities, cuts, axis=2), limits, strict=True)
    whole, coefficients, equilibrium = expected
    square = equilibrium.of_species * equilibrium.inverse_mass  # ⟨vx²⟩
    return tuple(
        _of_species(*part, lag, (whole, alone, float(1 / mean_square)))
        for part, alone, mean_square in zip(parts, coefficients, square, strict=True)
    )


def _of_species(
    name: str,
    places: np.ndarray,
    velocities: np.ndarray,
    limits: LagLimits,
    lag: np.ndarray,
    expected: tuple[Enskog | None, Theory | None, float],
) -> Diffusion:
    """Return the diffusion of one species, given positions and velocities (segments, L, discs, 2).

    expected: Enskog's coefficients, the theoretical D of the species, and 1/⟨vx²⟩.
    """
    remembered = correlation(velocities, velocities)
    square = remembered[:, 0].mean()
    displacement = mean_square_displacement(places)
    running = np.gradient(displacement, lag, axis=1) / 4
    count = math.sqrt(len(places))
    enskog, alone, inertia = expected
    entry = Diffusion(
        name,
        lag,
        remembered.mean(axis=0) / square,
        remembered.std(axis=0, ddof=1) / square / count,
        displacement.mean(axis=0),
        displacement.std(axis=0, ddof=1) / count,
        tail=np.append(math.inf, _tail(lag[1:], enskog)) if enskog else None,
        running=running.mean(axis=0),
        running_error=running.std(axis=0, ddof=1) / count,
        plateau=None,
        coefficient=None,
        velocity_correlation_time=None,
    )
    if limits.are_walls(lag, entry.displacement):
        return entry
    last = limits.within(entry.displacement)
    first = int(FITTED_FROM * last)
    late, slope = slice(first, last + 1), _slope(lag, displacement, first, last)
    if _falls(_slope(lag, displacement, int(FITTED_FROM * first), first), slope):
        return entry
    if alone:
        lost = limits.lost(float(entry.displacement[late].mean()))
        alone = replace(alone, error=alone.error + lost * alone.value)
    integral = velocity_integral(velocities, places)[:, late].mean(axis=1) / square
    return replace(
        entry,
        plateau=(float(lag[first]), float(lag[last])),
        coefficient=mean(slope, theory=alone),
        velocity_correlation_time=mean(integral, theory=alone and alone.times(inertia)),
    )


def _slope(lag: np.ndarray, displacement: np.ndarray, first: int, last: int) -> np.ndarray:
    """Return a quarter of the slope of mean square displacements (segments, L) between two lags, for each segment."""
    part = slice(first, last + 1)
    return np.polyfit(lag[part], displacement[:, part].T, 1)[0] / 4


def _falls(early: np.ndarray, late: np.ndarray) -> bool:
    """Return whether D clearly decreases from early to late lags; the arguments are D in each segment."""
    fall = mean(early - late)
    return fall.value > FALL * early.mean() and fall.interval(SURE)[0] > 0


def _tail(lag: np.ndarray, expected: Enskog) -> np.ndarray:
    return hard_discs.long_time_tail(lag, expected.density, expected.diffusion.value, expected.kinematic_viscosity)


def diffusion_caveats(entry: Diffusion, limits: LagLimits) -> Iterator[str]:
    """Yield a caveat if a species has no diffusion coefficient, or if its discs are not followed for long enough."""
    longest, name = float(entry.lag[-1]), entry.species
    if limits.are_walls(entry.lag, entry.displacement):
        far = math.sqrt(entry.displacement[entry.lag <= limits.needed][-1])
        width = math.sqrt(4 * limits.friction_d * limits.needed) / FREE_SHARE
        yield (
            f"Walls reflect discs of {name}, which move {far:.3g} in the time {limits.needed:.3g} that a diffusion "
            "coefficient requires: it cannot be measured in this box. Use periodic sides, or a box about "
            f"{width:.2g} wide and high."
        )
    elif entry.plateau is None:
        yield (
            f"No diffusion coefficient of {name}: D falls with the lag, to {entry.running[-1]:.3g} at {longest:.3g}. "
            "Discs in single file or in a crystal do not diffuse; in a dense fluid a larger --lag may give one."
        )
    elif longest * limits.rate < LEAST_LAG:
        yield (
            f"The window is short: {name} is followed for {longest * limits.rate:.2g} mean free times at most; its "
            f"diffusion coefficient and velocity correlation time require {LEAST_LAG:g}."
        )
    elif longest < limits.needed:
        yield (
            f"{name} is followed for only {longest:.3g}, while its velocity remains correlated: its diffusion "
            f"coefficient and velocity correlation time require {limits.needed:.3g}. Use a larger --lag."
        )
