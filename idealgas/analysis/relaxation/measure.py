"""Relaxation of a gas: its velocities at several instants, compared with Maxwell-Boltzmann's distribution.

All measures look at the reduced energy x = m v²/2T of a disc, whose law in equilibrium is exp(-x) whatever its mass:
the Kolmogorov-Smirnov distance D; the kurtosis ⟨v⁴⟩/⟨v²⟩², from 1 of equal speeds to 2; and, since the energy is
conserved, Boltzmann's H = ⟨ln f⟩ above its equilibrium value, which is the relative entropy of the two laws.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy import optimize

from idealgas.analysis.core.ensemble import ensemble
from idealgas.analysis.core.fields import OMITTED, Key, reported
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, ks_distance
from idealgas.analysis.core.stream import span
from idealgas.analysis.relaxation.acceptance import Acceptance, acceptance
from idealgas.analysis.relaxation.speeds import SpeedDistributions, speed_distributions
from idealgas.analysis.relaxation.velocities import (
    check_steady,
    collisions_per_disc,
    reduced_energy,
    reduced_energy_cdf,
)
from idealgas.errors import UserError
from idealgas.log import Log

HORIZON = 40.0
"""Default length of the window in collisions per disc: about ten relaxation times."""

SAMPLES = 320
CELLS = 32  # cells of equal probability for H
LEAST_RELAXATION = (
    4.0  # smallest deviation of the kurtosis at the start for a fit, in its standard deviations in equilibrium
)
SETTLED = 3.0
"""Relaxation times after which a gas counts as settled: 5 % of the distance is left."""

LINEAR = 2.0
"""Relaxation time of the kurtosis near equilibrium, in collisions per disc, for equal discs.

First Sonine approximation: van Noije & Ernst, Granular Matter 1, 57 (1998), elastic discs in two dimensions. Far from
equilibrium it takes longer: nearly 3 on the whole way from equal speeds.
"""

MEMORY = 2 / 3
"""Time for which fluctuations of the kurtosis last, in units of the relaxation time on the whole way: 2 over 3."""


MAXWELLIAN = 2.0
"""Kurtosis of an infinite gas in equilibrium."""

FEW = 100
"""Number of discs below which the error of the relaxation time is not known well."""


@dataclass(frozen=True)
class Relaxation(Result):
    """Relaxation of the gas of one log at K instants.

    path: of the log. number: of discs. time: (K,), times. collisions: (K,), collisions per disc since the first
    instant. kurtosis: (K,), ⟨v⁴⟩/⟨v²⟩² in reduced energies. distance: (K,), Kolmogorov-Smirnov distance. entropy: (K,),
    H - H_eq per disc. equilibrium_kurtosis: mean kurtosis of this number of discs in equilibrium. critical_distance:
    distance that one in twenty gases of this number of discs in equilibrium exceeds. in_time, in_collisions: fitted
    relaxation time of the kurtosis, in units of time and in collisions per disc; None if the kurtosis at the start is
    within its fluctuations in equilibrium. first_indistinguishable: index of the first instant at which the distance is
    below the critical distance; None if there is none. acceptance: acceptance of Monte Carlo trials; None for other
    methods. speeds: speed distributions; None unless they were counted.
    """

    path: str
    number: int
    time: np.ndarray
    collisions: Annotated[np.ndarray, Key("collisions_per_disc")]
    kurtosis: np.ndarray
    distance: np.ndarray
    entropy: np.ndarray
    equilibrium_kurtosis: float
    critical_distance: float
    in_time: Annotated[Estimate | None, Key("relaxation_time")]
    in_collisions: Annotated[Estimate | None, Key("relaxation_collisions_per_disc")]
    first_indistinguishable: Annotated[int | None, OMITTED]
    acceptance: Acceptance | None
    speeds: Annotated[SpeedDistributions | None, Key("speed_distributions")]

    @property
    @reported
    def settled_time(self) -> float | None:
        """Time after which a gas counts as settled; None without a relaxation time."""
        return SETTLED * self.in_time.value if self.in_time else None

    @property
    @reported
    def indistinguishable_after(self) -> dict[str, float] | None:
        """Time and collisions per disc at `first_indistinguishable`; None if there is none."""
        if (k := self.first_indistinguishable) is None:
            return None
        return {"time": float(self.time[k]), "collisions_per_disc": float(self.collisions[k])}


def relaxation(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    every: float | None = None,
) -> Relaxation:
    """Follow the relaxation of the speeds to the Maxwell-Boltzmann distribution, and fit its time.

    start, end: times; by default from the start of the log until HORIZON collisions per disc later. progress(done, in
    all) is called as states are read. Raises UserError if no two discs collide in between, or if the energy of the
    discs is not constant, so that there is no distribution that they tend to.
    """
    check_steady(log)
    first, last = colliding_span(log, start, end)
    time = np.linspace(first, last, SAMPLES + 1)
    equilibrium = ensemble(log)
    number = len(log.discs)
    distance, entropy = np.empty((2, len(time)))
    kurtosis = np.empty(len(time))
    for k, state in enumerate(log.frames(time)):
        energy = reduced_energy(log, state.velocity, equilibrium)
        if not energy.any():
            raise UserError(f"{log.path}: no disc moves at t = {state.time:g}")
        distance[k], entropy[k] = ks_distance(energy, reduced_energy_cdf), relative_entropy(energy)
        kurtosis[k] = number * (energy**2).sum() / energy.sum() ** 2
        if progress is not None:
            progress(k + 1, len(time))
    collisions = collisions_per_disc(log, time)
    target = 2 / (1 + 2 / equilibrium.dof)
    critical = critical_distance(number)
    indistinguishable = np.flatnonzero(distance < critical)
    in_collisions = _fit(collisions, kurtosis, number, target)
    return Relaxation(
        path=str(log.path),
        number=number,
        time=time,
        collisions=collisions,
        kurtosis=kurtosis,
        distance=distance,
        entropy=entropy,
        equilibrium_kurtosis=target,
        critical_distance=critical,
        in_time=_fit(time - first, kurtosis, number, target),
        in_collisions=in_collisions,
        first_indistinguishable=int(indistinguishable[0]) if len(indistinguishable) else None,
        acceptance=acceptance(log),
        speeds=None if every is None else speed_distributions(log, every, start, end),
        caveats=(
            *_doubts(in_collisions, float(collisions[-1]), number, float(kurtosis[0])),
            *_late(in_collisions, first > log.start_time),
        ),
    )


def _doubts(fit: Estimate | None, seen: float, number: int, kurtosis: float) -> Iterator[str]:
    """Sentences on a relaxation time, in collisions per disc, fitted to `number` discs followed for `seen` of these.

    kurtosis: at the start.
    """
    if fit is None:
        return
    if seen < fit.value:
        yield (
            f"The log is followed for {seen:.2g} collisions per disc, less than the relaxation time that was fitted, "
            f"{fit.value:.2g}: that is an extrapolation."
        )
    if kurtosis > MAXWELLIAN:
        yield (
            f"The error of the relaxation time is that of a start with equal speeds; here a few discs are faster than "
            f"most (kurtosis {kurtosis:.3g}, in equilibrium 2), and chance decides how soon they meet others."
        )
    if number < FEW:
        yield f"The error of the relaxation time was calibrated with 200 and 500 discs; here are {number}."


def _late(fit: Estimate | None, late: bool) -> tuple[str, ...]:
    """Sentence on a course that begins after the start of the log, by chance nearer to equilibrium or farther."""
    if fit is None or not late:
        return ()
    return ("The error of the relaxation time is that of a start with equal speeds; later curves scatter more.",)


def colliding_span(log: Log, start: float | None, end: float | None) -> tuple[float, float]:
    """First and last time to follow; by default it ends after HORIZON collisions per disc or at the end of the log.

    Raises:
        UserError: if no discs collide between the two times.
    """
    first, last = span(log, start, end)
    most = HORIZON * len(log.discs) if end is None else math.inf
    found = 0
    for rows in log.chunks(("time", "partner"), log.row_at(first, "right"), log.row_at(last, "right")):
        pairs = np.flatnonzero(rows.partner >= 0)
        if found + len(pairs) > most:
            return first, float(rows.time[pairs[int(most) - found]])
        found += len(pairs)
    if not found:
        raise UserError(f"{log.path}: no two discs collide between t = {first:g} and {last:g}")
    return first, last


def relative_entropy(energy: np.ndarray) -> float:
    """Relative entropy ∫ p ln(p/e^(-x)) dx of reduced energies (N,), estimated in cells of equal probability (no unit).

    The bias (cells - 1)/2N is subtracted: Miller (1955). The estimate is at most ln(cells), for equal speeds, whose
    relative entropy is infinite.
    """
    n = len(energy)
    cells = max(2, min(CELLS, n // 5))
    cell = np.minimum((reduced_energy_cdf(energy) * cells).astype(int), cells - 1)
    share = np.bincount(cell, minlength=cells) / n
    seen = share[share > 0]
    return float((seen * np.log(seen * cells)).sum() - (cells - 1) / (2 * n))


def critical_distance(number: int) -> float:
    """Kolmogorov-Smirnov distance that one in twenty gases of `number` discs in equilibrium exceeds (no unit).

    It is that of an exponential law with fitted mean, as the total energy is fixed: Stephens, J. Am. Stat. Assoc. 69,
    730 (1974), table 1.5.
    """
    root = math.sqrt(number)
    return 1.094 / (root + 0.26 + 0.5 / root) + 0.2 / number


def _fit(time: np.ndarray, kurtosis: np.ndarray, number: int, target: float) -> Estimate | None:
    """Relaxation time of the kurtosis (S,) from its first value to its target by least squares, in the unit of `time`.

    The error is that of the fluctuations of a gas of `number` discs. Their variance in equilibrium is that of equally
    probable shares of the energy. They start from none and grow with the way that is done: so it was found in 300 runs
    each of 200 and 500 discs from equal speeds, with errors right to 2 % ± 4 %. Discs cannot be taken as independent of
    each other, as a collision changes two at once.
    """
    if abs(kurtosis[0] - target) < LEAST_RELAXATION * 2 / math.sqrt(number):
        return None
    value = decay_time(time, kurtosis, target)
    left = np.exp(-time / value)
    slope = (target - kurtosis[0]) * time / value**2 * left
    scatter = kurtosis_variance(number) * np.outer(1 - left, 1 - left)
    scatter *= np.exp(-np.abs(np.subtract.outer(time, time)) / (MEMORY * value))
    error = math.sqrt(float(slope @ scatter @ slope)) / float(slope @ slope)
    return Estimate(value, error, float(number))


def kurtosis_variance(number: int) -> float:
    """Variance of the kurtosis ⟨v⁴⟩/⟨v²⟩² of N discs in equilibrium, whose shares of the energy are all as probable.

    It is N² times the variance of the sum of the squares of N uniform spacings: about 4/N.
    """
    n = number
    return 4 * n**2 * (n - 1) / ((n + 1) ** 2 * (n + 2) * (n + 3))


def decay_time(time: np.ndarray, series: np.ndarray, target: float) -> float:
    """Relaxation time τ of target + (series[0] - target) exp(-time/τ), fitted to a series by least squares.

    time, series: (S,). The result has the unit of `time`.
    """

    def misfit(logarithm: float) -> float:
        model = target + (series[0] - target) * np.exp(-time * math.exp(-logarithm))
        return float(((series - model) ** 2).sum())

    low, high = math.log(time[time > 0][0] / 10), math.log(10 * time[-1])
    start = min(np.linspace(low, high, 40), key=misfit)
    step = (high - low) / 39
    found = optimize.minimize_scalar(misfit, bounds=(start - step, start + step), method="bounded")
    return math.exp(found.x)


@dataclass(frozen=True)
class Relaxations(Result):
    """Relaxation of the gas of each log."""

    logs: tuple[Relaxation, ...]


def combine_relaxation(results: Sequence[Relaxation]) -> Relaxations:
    """Combine the relaxation of several logs, in their order."""
    return Relaxations(tuple(results))
