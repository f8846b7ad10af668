"""Distributions of free flights, waiting times, impact parameters and numbers of collisions."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from idealgas.analysis.histogram.distribution import ALL_DISCS, BINS, Distribution, distribution_of
from idealgas.analysis.histogram.laws import (
    DENSEST_COUNTS,
    FEW,
    FINITE_NUMBER,
    RECOLLISIONS,
    count_errors,
    expectation,
    free_flight_rates,
)
from idealgas.errors import NotApplicableError
from idealgas.log import Log
from idealgas.statistics.estimates import estimate, of_events, ratio
from idealgas.tallies.collision_statistics import CollisionCounts, ImpactParameters
from idealgas.tallies.equilibration import Window, measure
from idealgas.tallies.equilibrium import nonstationary_reason
from idealgas.tallies.intervals import FreeFlights, Intervals, WaitingTimes
from idealgas.tallies.stream import ReadProgress, span
from idealgas.theory import distributions
from idealgas.theory.collision_counts import CollisionCountLaw
from idealgas.theory.ensemble import classes
from idealgas.theory.values import Theory

INTERVALS = 10_000  # approximate number of intervals that are sampled for the tests
STRIDE = 7  # at most every 7th interval is sampled, as successive flights of a disc are correlated
TAIL = 12  # flights that start in the last 12 mean free times are not counted, as long flights would be cut off

COUNTED = 10.0
"""Duration over which collisions are counted, in mean free times; at most one 64th of the log."""

MOST_COUNTED = 24
"""Number of bins for numbers of collisions."""

Found = tuple[Window, list[Distribution], str]
"""Window, distributions, and the reason why theory predicts no distribution (empty if it predicts one)."""


def free_flights(
    log: Log, quantity: str, start: float | None, end: float | None, progress: ReadProgress | None
) -> Found:
    """Measure the distribution of the free paths or the free times of each species."""
    discs, path = classes(log.discs), quantity == "free-path"
    temperature, rates, errors, speed, reason = free_flight_rates(log, discs, start, end)
    per_disc = rates.sum(axis=1)
    rate = discs.shares @ per_disc
    average = speed / rate if path else 1 / rate
    relative = discs.shares @ (errors * rates).sum(axis=1) / rate
    high = 10 * average
    tally = FreeFlights(path, high, BINS, max(STRIDE, len(log) // INTERVALS), 2 * INTERVALS)
    window = measure(log, [tally], start, end, progress)
    last = len(tally.counts) - int(np.ceil(TAIL / rate.min() / window.width))
    blocks = slice(window.first, max(last, (window.first + len(tally.counts)) // 2))
    finite = FINITE_NUMBER / len(log.discs)
    law = distributions.FreePathLaw if path else distributions.FreeTimeLaw
    by_species = []
    for s, name in enumerate(log.discs.species_names):
        kinds = np.flatnonzero(discs.species == s)
        laws = tuple(law(temperature, discs.mass[k], tuple(discs.mass), tuple(rates[k])) for k in kinds)
        flights = tuple((discs.number * per_disc)[kinds].tolist())  # discs that collide more often have more flights
        dilute = laws[0] if len(laws) == 1 else distributions.MeanLaw(laws, flights)
        possible = {} if reason else {"dilute gas": dilute}
        expected = None if reason else Theory(float(average[s]), float(average[s] * relative[s]), "kinetic theory")
        by_species.append(_intervals(name, tally, s, blocks, high[s], possible, expected, RECOLLISIONS + finite))
    return window, by_species, reason


def waiting_times(log: Log, start: float | None, end: float | None, progress: ReadProgress | None) -> Found:
    """Measure the distribution of the times between successive events in the whole gas."""
    longest = 20 * (log.end_time - log.start_time) / max(len(log), 1)  # a collision between two discs has two rows
    tally = WaitingTimes(np.array([longest]), BINS, max(STRIDE, len(log) // INTERVALS), 2 * INTERVALS)
    window = measure(log, [tally], start, end, progress)
    blocks = slice(window.first, len(tally.counts))
    reason = nonstationary_reason(log)
    if log.has_positions and len(log.discs) < FEW:
        reason = reason or f"theory assumes many discs, but this gas has only {len(log.discs)}"
    with np.errstate(divide="ignore", invalid="ignore"):
        law = distributions.WaitingTimeLaw(tally.counts[blocks].sum() / tally.sums[blocks].sum())
    possible, error = {} if reason else {"exponential": law}, FINITE_NUMBER / len(log.discs)
    return window, [_intervals(ALL_DISCS, tally, 0, blocks, longest, possible, None, error)], reason


def impact_parameters(log: Log, start: float | None, end: float | None, progress: ReadProgress | None) -> Found:
    """Measure the distribution of impact parameters |b|, divided by the sum of the radii, for collisions of all discs.

    In equilibrium, velocities are independent of positions, so that the distribution is uniform at any density.
    """
    if not log.has_positions:
        raise NotApplicableError(f"{log.path}: impact parameters require discs with positions")
    tally = ImpactParameters(log.periodic, BINS, max(STRIDE, len(log) // 2 // INTERVALS), 2 * INTERVALS)
    window = measure(log, [tally], start, end, progress)
    reason = expectation(log, start, end).reason
    possible = {} if reason else {"uniform": distributions.UniformLaw()}
    mean = None if reason else 0.5
    return (
        window,
        [_intervals(ALL_DISCS, tally, 0, slice(window.first, len(tally.counts)), 1.0, possible, mean, 0.0)],
        reason,
    )


def collision_counts(log: Log, start: float | None, end: float | None, progress: ReadProgress | None) -> Found:
    """Measure the distribution of the number of collisions of a disc in a fixed duration, and its cumulants."""
    discs = classes(log.discs)
    _, rates, errors, _, reason = free_flight_rates(log, discs, start, end)
    if len(discs.mass) > 1:
        reason = reason or "it is known only for equal discs"
    if log.has_positions and log.discs.packing_fraction > DENSEST_COUNTS:
        reason = reason or f"the distribution of numbers of collisions is not known above φ = {DENSEST_COUNTS:g}"
    per_disc, (first, last) = rates.sum(axis=1), span(log, start, end)
    rate = discs.shares @ per_disc
    fewest, most = 64, max(len(log), 64)  # at most one interval per row of the log, even if most intervals are empty
    time = float(np.clip(COUNTED / rate.max(), (last - first) / most, (last - first) / fewest))
    tally = CollisionCounts(time, MOST_COUNTED, max(STRIDE, int((last - first) / time * len(log.discs) / INTERVALS)))
    window = measure(log, [tally], start, end, progress)
    begin = int(tally.begins.searchsorted(window.start))
    error, *of_cumulants = count_errors(log)
    edges, by_species = np.arange(MOST_COUNTED + 1) - 0.5, []
    mean = law = None
    cumulants: list[Theory | None] = [None, None]
    if not reason:
        mean = Theory(float(rate[0]) * time, float(rate[0] * errors[0, 0]) * time, "kinetic theory")
        law = CollisionCountLaw(float(rate[0]) * time)
        cumulants = [Theory(*value, "dilute gas") for value in zip(law.cumulants, of_cumulants, strict=True)]
    for s, name in enumerate(log.discs.species_names):
        chosen = (tally.sample_species == s) & (tally.sample_index >= begin)
        even = np.random.default_rng(0).uniform(-0.5, 0.5, int(chosen.sum()))
        sums = tally.sums[begin:, s].T
        collided = float(sums[1].sum())
        average = of_events(ratio(sums[1], sums[0], theory=mean), collided)
        distribution = distribution_of(
            name,
            edges,
            tally.counts[begin:, s],
            average,
            tally.sample[chosen] + even,
            None,
            {"dilute gas": law} if law else {},
            error,
        )
        measured = {
            "variance_over_mean": of_events(estimate(_variance, *sums[:3], theory=cumulants[0]), collided),
            "third_cumulant_over_mean": of_events(estimate(_third, *sums, theory=cumulants[1]), collided),
        }
        by_species.append(replace(distribution, counted_in=time, cumulants=measured))
    return window, by_species, reason


def _variance(number: float, first: float, second: float) -> float:
    """Return the variance over the mean, from sums of the zeroth to second powers."""
    mean = first / number
    return (second / number - mean**2) / mean


def _third(number: float, first: float, second: float, third: float) -> float:
    """Return the third cumulant over the mean, from sums of the zeroth to third powers."""
    mean = first / number
    return (third / number - 3 * mean * second / number + 2 * mean**3) / mean


def _intervals(
    name: str,
    tally: Intervals,
    s: int,
    blocks: slice,
    high: float,
    possible: Mapping[str, distributions.Law],
    expected: Theory | float | None,
    law_error: float,
) -> Distribution:
    """Return the distribution of the intervals of species s in a range of time blocks."""
    counts = tally.counts[blocks, s].astype(float)
    chosen = (tally.sample_species == s) & (tally.sample_block >= blocks.start) & (tally.sample_block < blocks.stop)
    average = of_events(ratio(tally.sums[blocks, s], counts.sum(axis=1), theory=expected), float(counts.sum()))
    samples, edges = tally.sample[chosen], np.linspace(0, high, BINS + 1)
    return distribution_of(name, edges, counts, average, samples, None, possible, law_error)
