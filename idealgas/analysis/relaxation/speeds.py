"""Speeds of discs compared with equilibrium: distances from its distribution, relaxation time, classes of speed.

In equilibrium the reduced energy x of a disc has the probability density exp(-x).
"""

import math
from dataclasses import dataclass
from itertools import count, takewhile
from typing import Annotated

import numpy as np
from scipy import optimize

from idealgas.analysis.relaxation.acceptance import last_trial
from idealgas.errors import UserError
from idealgas.fields import Key
from idealgas.log import Log
from idealgas.presentation.tables import Cell, Number, Table
from idealgas.statistics.estimates import Estimate, ks_distance
from idealgas.tallies.collisions import collisions_per_disc
from idealgas.tallies.equilibrium import ensemble
from idealgas.tallies.stream import span
from idealgas.theory.ensemble import Ensemble, composition

CLASSES = 0.3 * np.arange(9)
"""Lower limits of the classes of speed, in units of the root-mean-square speed; the last class has no upper limit."""

MOST_INSTANTS = 10_000

HORIZON = 40.0
"""Default length of the window, in collisions per disc; it is more than ten relaxation times."""

CELLS = 32
"""Number of cells of equal probability from which H is estimated."""

LEAST_RELAXATION = 4.0
"""Smallest initial deviation of the kurtosis for which a decay is fitted, in standard deviations in equilibrium."""

MEMORY = 2 / 3
"""Correlation time of the fluctuations of the kurtosis (2 collisions per disc) over the relaxation time (3)."""


def check_steady(log: Log) -> None:
    """Check that the velocities in a log can relax to the Maxwell-Boltzmann distribution.

    Raises:
        UserError: if the log has no events, if the kinetic energy of the discs is not constant, or if no disc moves.
    """
    log.require_events()
    if restless := log.scene.lacking("conserves_motion"):
        raise UserError(
            f"{log.path}: relaxation requires constant kinetic energy; use `idealgas evolution` for a gas with "
            f"{', '.join(restless)}"
        )
    if not log.discs.temperature > 0:
        raise UserError(f"{log.path}: no disc moves")


def colliding_span(log: Log, start: float | None, end: float | None) -> tuple[float, float]:
    """Return the start and end of the window, by default up to HORIZON collisions per disc or the end of the log.

    Raises:
        UserError: if no discs collide between the two times.
    """
    first, last = span(log, start, end)
    most = HORIZON * len(log.discs) if end is None else math.inf
    collisions = 0
    for rows in log.chunks(("time", "partner"), log.row_at(first, "right"), log.row_at(last, "right")):
        pairs = np.flatnonzero(rows.partner >= 0)
        if collisions + len(pairs) > most:
            return first, float(rows.time[pairs[int(most) - collisions]])
        collisions += len(pairs)
    if not collisions:
        raise UserError(f"{log.path}: no two discs collide between t = {first:g} and {last:g}")
    return first, last


def reduced_energy(log: Log, velocity: np.ndarray, equilibrium: Ensemble) -> np.ndarray:
    """Return the reduced energy m vx²/2Tx + m vy²/2Ty of every disc (no unit), with its equilibrium temperatures."""
    gas = log.discs
    square = (velocity - equilibrium.centre_of_mass_velocity) ** 2 / equilibrium.of_axes[gas.species]
    return gas.mass * square.sum(axis=1) / 2


def reduced_energy_cdf(energy: np.ndarray) -> np.ndarray:
    """Return the cumulative distribution of reduced energies in equilibrium, 1 - exp(-x)."""
    return -np.expm1(-energy)


def relative_entropy(energy: np.ndarray) -> float:
    """Return the relative entropy ∫ p ln(p/e^(-x)) dx of reduced energies (N,), from cells of equal probability.

    The bias (cells - 1)/2N is subtracted (Miller 1955). Equal speeds have an infinite relative entropy; the estimate
    cannot exceed ln(cells).
    """
    n = len(energy)
    cells = max(2, min(CELLS, n // 5))
    cell = np.minimum((reduced_energy_cdf(energy) * cells).astype(int), cells - 1)
    share = np.bincount(cell, minlength=cells) / n
    seen = share[share > 0]
    return float((seen * np.log(seen * cells)).sum() - (cells - 1) / (2 * n))


def critical_distance(number: int) -> float:
    """Return the Kolmogorov-Smirnov distance that one in twenty gases of `number` discs exceeds in equilibrium.

    It is the critical value for an exponential distribution whose mean was fitted to the data, because the total energy
    is fixed: Stephens, J. Am. Stat. Assoc. 69, 730 (1974), table 1.5.
    """
    root = math.sqrt(number)
    return 1.094 / (root + 0.26 + 0.5 / root) + 0.2 / number


def fit_decay(time: np.ndarray, kurtosis: np.ndarray, number: int, target: float) -> Estimate | None:
    """Fit the relaxation time of the kurtosis (S,) from its first value to its target, in the unit of `time`.

    The standard error follows from the fluctuations of the kurtosis in a gas of `number` discs. These grow from zero as
    the gas relaxes. Their variance in equilibrium, about 4/N, is that of a uniformly random division of the energy
    among the discs. Discs are not independent of each other, because each collision changes two of them at once. In 300
    runs each of 200 and of 500 discs with equal initial speeds, the standard errors were right to within 2 % ± 4 %.

    Return None if the initial deviation is within the fluctuations in equilibrium.
    """
    if abs(kurtosis[0] - target) < LEAST_RELAXATION * 2 / math.sqrt(number):
        return None
    value = decay_time(time, kurtosis, target)
    left = np.exp(-time / value)
    slope = (target - kurtosis[0]) * time / value**2 * left
    n = number
    variance = (
        4 * n**2 * (n - 1) / ((n + 1) ** 2 * (n + 2) * (n + 3))
    )  # n² times the variance of the sum of squared spacings
    scatter = variance * np.outer(1 - left, 1 - left)
    scatter *= np.exp(-np.abs(np.subtract.outer(time, time)) / (MEMORY * value))
    error = math.sqrt(float(slope @ scatter @ slope)) / float(slope @ slope)
    return Estimate(value, error, float(number))


def decay_time(time: np.ndarray, series: np.ndarray, target: float) -> float:
    """Return τ from a least-squares fit of target + (series[0] - target) exp(-time/τ) to a series.

    The arrays `time` and `series` have shape (S,), and the result has the unit of `time`.
    """

    def misfit(logarithm: float) -> float:
        model = target + (series[0] - target) * np.exp(-time * math.exp(-logarithm))
        return float(((series - model) ** 2).sum())

    low, high = math.log(time[time > 0][0] / 10), math.log(10 * time[-1])
    start = min(np.linspace(low, high, 40), key=misfit)
    step = (high - low) / 39
    result = optimize.minimize_scalar(misfit, bounds=(start - step, start + step), method="bounded")
    return math.exp(result.x)


# ── classes of speed ──


@dataclass(frozen=True)
class SpeedDistributions:
    """Speed distributions at K instants in C classes of speed.

    Along axes along which momentum is conserved, velocities are relative to the centre of mass.

    Attributes:
        time: (K,), times.
        trials: (K,), number of Monte Carlo trials up to each time; None for a method without trials.
        collisions: (K,), collisions per disc up to each time.
        distance: (K,), Kolmogorov-Smirnov distance from the Maxwell-Boltzmann distribution.
        rms: root-mean-square speed, length/time.
        edges: (C,), lower limits of the classes, length/time.
        counts: (K, C), numbers of discs.
        expected: (C,), numbers of discs expected from the Maxwell-Boltzmann distribution.
    """

    time: np.ndarray
    trials: np.ndarray | None
    collisions: Annotated[np.ndarray, Key("collisions_per_disc")]
    distance: np.ndarray
    rms: Annotated[float, Key("rms_speed")]
    edges: Annotated[np.ndarray, Key("speed_from")]
    counts: np.ndarray
    expected: Annotated[np.ndarray, Key("maxwell_boltzmann")]


def speed_distributions(
    log: Log, every: float, start: float | None = None, end: float | None = None
) -> SpeedDistributions:
    """Count discs by speed at the start and then every `every` trials (Monte Carlo) or units of time (other methods).

    Raises:
        UserError: if there would be more than MOST_INSTANTS instants, or if the gas does not relax (`check_steady`).
    """
    check_steady(log)
    first, last = span(log, start, end)
    trials = None
    if "trial" in log.columns:
        trials, time = _at_trials(log, every, first, last)
    else:
        _check_number((last - first) / every)
        time = np.array(list(takewhile(lambda t: t <= last, (first + k * every for k in count()))))
    gas, equilibrium = log.discs, ensemble(log)
    rms = math.sqrt(((gas.velocity - equilibrium.centre_of_mass_velocity) ** 2).sum() / len(gas))
    edges = rms * CLASSES
    counts, distance = [], []
    for state in log.frames(time):
        speed = np.hypot(*(state.velocity - equilibrium.centre_of_mass_velocity).T)
        counts.append(np.histogram(speed, [*edges, math.inf])[0])
        distance.append(ks_distance(reduced_energy(log, state.velocity, equilibrium), reduced_energy_cdf))
    expected = np.zeros(len(edges))
    for s, number in enumerate(composition(gas).number):
        law = equilibrium.velocity_law("speed", s, math.inf)
        expected += number * np.diff(law.cdf(edges), append=1.0)
    collisions = collisions_per_disc(log, time)
    return SpeedDistributions(time, trials, collisions, np.array(distance), rms, edges, np.array(counts), expected)


def _at_trials(log: Log, every: float, first: float, last: float) -> tuple[np.ndarray, np.ndarray]:
    """Return numbers of trials at equal intervals, and the time of the last collision up to each of them."""
    total = log.summary["trials"] if log.complete else last_trial(log)
    _check_number(total / every)
    wanted = np.arange(0, total + 1, max(int(every), 1))
    time = np.full(len(wanted), log.start_time)
    for rows in log.chunks(("time", "trial")):
        done = np.searchsorted(rows.trial, wanted.astype(np.uint64), "right")
        time = np.where(done > 0, rows.time[np.maximum(done - 1, 0)], time)
    inside = (first <= time) & (time <= last)
    return wanted[inside], time[inside]


def _check_number(instants: float) -> None:
    if instants > MOST_INSTANTS:
        raise UserError(f"{instants:.3g} instants are too many for a table (allowed <= {MOST_INSTANTS})")


def speed_table(path: str, speeds: SpeedDistributions) -> Table:
    """Return the table of the numbers of discs by speed, with a row for each instant and a last row for theory."""
    title = f"{path}: discs by speed, in classes that start at multiples of {speeds.rms:.4g} (rms)"
    classes = (f"{edge / speeds.rms:.1f}" for edge in speeds.edges)
    clock = [Number(t, ".4g") for t in speeds.time.tolist()]
    if speeds.trials is not None:
        clock = [Number(trial, ",") for trial in speeds.trials.tolist()]
    columns = zip(
        clock,
        speeds.collisions.tolist(),
        speeds.distance.tolist(),
        speeds.counts.tolist(),
        strict=True,
    )
    rows: list[tuple[Cell, ...]] = [
        (instant, Number(collisions, ".2f"), Number(distance, ".3f"), *(Number(n, "d") for n in counts))
        for instant, collisions, distance, counts in columns
    ]
    rows.append(("law", "", "", *(Number(number, ".1f") for number in speeds.expected.tolist())))
    return Table(title, ("time" if speeds.trials is None else "trials", "coll/disc", "KS", *classes), rows)
