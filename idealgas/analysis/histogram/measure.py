"""Distributions of speeds, energies, free flights and waiting times, with Kolmogorov-Smirnov tests of their laws.

Histograms of velocities weight every value with the time that discs spend at it; histograms of intervals count every
interval once. The tests use decorrelated samples: velocities of some discs at instants one correlation time apart, or
every n-th interval.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy import stats

from idealgas.analysis.core.autoregression import inefficiency
from idealgas.analysis.core.collisions import expected_rates, theory_of
from idealgas.analysis.core.ensemble import Composition, composition, nonstationary_reason
from idealgas.analysis.core.equilibration import Window, measure
from idealgas.analysis.core.fields import OMITTED, Key, reported
from idealgas.analysis.core.flights import VELOCITY_QUANTITIES, Moments, VelocityHistogram
from idealgas.analysis.core.intervals import FreeFlights, WaitingTimes
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, mean, mean_of_flux, ratio
from idealgas.analysis.histogram.laws import expectation
from idealgas.analysis.theory import distributions
from idealgas.analysis.theory.hard_discs import mean_speed
from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.state import Gas

QUANTITIES = {
    "speed": "length/time",
    "vx": "length/time",
    "vy": "length/time",
    "energy": "energy",
    "free-path": "length",
    "free-time": "time",
    "waiting-time": "time",
}
"""Quantities whose distribution can be measured, with their units."""

BINS = 120
SAMPLED = 256  # largest number of discs of a species whose velocities are tested
INTERVALS = 10_000  # approximate number of intervals that are tested
FEWEST_SAMPLES = 30  # of a test; the distance that one in twenty correct laws exceeds is then 0.24
STRIDE = 7  # at least every 7th interval is a sample, as successive flights of a disc are correlated
FEW = 30  # discs below which free paths do not follow the law of many
TAIL = 12  # mean free times before the end of a window from which no flight is counted, as long ones would be cut off


@dataclass(frozen=True)
class Test:
    """Kolmogorov-Smirnov test of samples against a law.

    law_name: name of the law. law: the distribution. distance: largest difference of the distribution functions (no
    unit). p_value: probability of at least this distance by chance.
    """

    law_name: Annotated[str, Key("law")]
    law: Annotated[distributions.Law, OMITTED]
    distance: float
    p_value: float


@dataclass(frozen=True)
class Distribution:
    """Distribution of one quantity for one species, or for the whole gas.

    name: of the species. edges: (bins + 1,), edges of the bins, in the unit of the quantity. density: (bins,),
    probability density, 1/unit. error: (bins,), standard error of the density. mean: mean of the quantity. samples:
    number of decorrelated samples. correlation_time: time between independent samples of one disc; None for intervals.
    tests: Kolmogorov-Smirnov tests, one for each law.
    """

    name: str
    edges: np.ndarray
    density: np.ndarray
    error: np.ndarray
    mean: Estimate
    samples: int
    correlation_time: float | None
    tests: tuple[Test, ...]

    @property
    @reported
    def laws(self) -> dict[str, np.ndarray]:
        """Probability density (bins,) by each law in the middle of the bins, 1/unit."""
        middle = (self.edges[1:] + self.edges[:-1]) / 2
        return {test.law_name: test.law.pdf(middle) for test in self.tests}


@dataclass(frozen=True)
class Histogram(Result):
    """Distributions of one quantity (with its unit) in a window of time, one for each species.

    no_law: why no law holds, as part of a sentence; None if one does.
    """

    quantity: str
    unit: str
    window: Window
    distributions: tuple[Distribution, ...]
    no_law: str | None = None


Progress = Callable[[int, int], None] | None


def histogram(
    log: Log, quantity: str = "speed", start: float | None = None, end: float | None = None, progress: Progress = None
) -> Histogram:
    """Measure a distribution between two times of a log, species by species, and test it against its laws.

    quantity: speed, vx, vy or energy of a disc; free-path or free-time of a disc between two collisions with discs;
    or waiting-time, the time between two successive events of the gas. Velocities are compared with the
    Maxwell-Boltzmann distribution and that of N discs at fixed energy, free flights with a dilute gas, and waiting
    times with an exponential distribution. The p-values are those of the Kolmogorov-Smirnov test of decorrelated
    samples. Under gravity or a piston the temperature of the law is the measured one. A gas that never comes to
    equilibrium has no law, and its window is the whole log by default.

    start, end: times; by default from detected equilibrium to the end of the log. progress(done, in all) is called as
    events are read. Raises UserError if no disc moves or if there are too few events in the window.
    """
    if start is None and nonstationary_reason(log):
        start = log.start_time
    if quantity in VELOCITY_QUANTITIES:
        window, found, no_law = _velocities(log, quantity, start, end, progress)
    elif quantity == "waiting-time":
        window, found, no_law = _waiting_times(log, start, end, progress)
    else:
        window, found, no_law = _flights(log, quantity, start, end, progress)
    few = [
        f"The tests of {each.name} have {each.samples} decorrelated samples; with fewer than {FEWEST_SAMPLES} they can "
        "hardly fail."
        for each in found
        if each.tests and each.samples < FEWEST_SAMPLES
    ]
    return Histogram(quantity, QUANTITIES[quantity], window, tuple(found), no_law or None, caveats=tuple(few))


Found = tuple[Window, list[Distribution], str]
"""Window, distributions, and why no law holds, empty if one does."""


# ── velocities ──


def _velocities(log: Log, quantity: str, start: float | None, end: float | None, progress: Progress) -> Found:
    gas, discs, known = log.discs, composition(log.discs), expectation(log, start, end)
    thermal = np.sqrt(known.scale / discs.mass)
    high = np.full(len(thermal), 12 * known.scale) if quantity == "energy" else 5 * thermal
    low = -high if quantity in ("vx", "vy") else np.zeros_like(high)
    members = [_some_discs(gas, s) for s in range(len(thermal))]
    tally, moments = VelocityHistogram(quantity, low, high, BINS, np.concatenate(members), log.gravity), []
    if known.needs_temperature:
        moments.append(Moments(log.gravity))
    window = measure(log, [tally, *moments], start, end, progress)
    measured = None
    if moments:
        measured = float(window.of(moments[0].flights)[:, :, 1:3].sum(axis=(1, 2)).mean()) / (2 * len(gas))
    parts = np.split(tally.snapshots[window.first :], np.cumsum([len(ids) for ids in members])[:-1], axis=1)
    confined = quantity in ("vx", "vy") and log.has_positions and not log.periodic["xy".index(quantity[1])]
    found = []
    for s, (name, snapshots) in enumerate(zip(discs.name, parts, strict=True)):
        possible = known.laws(quantity, discs, s, measured)
        # A light disc among heavy ones keeps its speed for longer than its direction.
        spacing = int(np.ceil(max(inefficiency(snapshots), inefficiency(snapshots**2))))
        expected = list(possible.values())[-1].mean if possible and measured is None else None
        found.append(
            _distribution(
                name,
                np.linspace(low[s], high[s], BINS + 1),
                window.of(tally.counts)[:, s],
                _mean(window.of(tally.sums)[:, s] / discs.number[s], high[s], expected, confined),
                snapshots[::spacing].ravel(),
                spacing * window.width,
                possible,
            )
        )
    return window, found, known.why_not


def _mean(series: np.ndarray, scale: float, expected: float | None, confined: bool) -> Estimate:
    """Mean of a series of values of magnitude `scale`; a conserved quantity only varies by rounding, without error.

    confined: whether the quantity is a velocity between walls, whose integral over time is a place in the box.
    """
    if np.ptp(series) < 1e-12 * scale:
        return Estimate(float(series.mean()), 0.0, 1.0, expected)
    if confined:
        return mean_of_flux(series, np.zeros(len(series)), expected)
    return mean(series, theory=expected)


def _some_discs(gas: Gas, species: int) -> np.ndarray:
    """Discs whose velocities are sampled: at most a quarter of a species, as the total energy correlates velocities."""
    members = np.flatnonzero(gas.species == species)
    return members[:: max(4, -(-len(members) // SAMPLED))]


# ── intervals ──


def _flights(log: Log, quantity: str, start: float | None, end: float | None, progress: Progress) -> Found:
    discs, path = composition(log.discs), quantity == "free-path"
    temperature, rates, speed, why_not = _free_flight_rates(log, discs, start, end)
    rate = rates.sum(axis=1)
    average = speed / rate if path else 1 / rate
    high = 10 * average
    tally = FreeFlights(path, high, BINS, max(STRIDE, len(log) // INTERVALS), 2 * INTERVALS, log.gravity)
    window = measure(log, [tally], start, end, progress)
    last = len(tally.counts) - int(np.ceil(TAIL / rate.min() / window.width))
    blocks = slice(window.first, max(last, (window.first + len(tally.counts)) // 2))
    law = distributions.FreePathLaw if path else distributions.FreeTimeLaw
    found = []
    for s, name in enumerate(discs.name):
        dilute = law(temperature, discs.mass[s], tuple(discs.mass), tuple(rates[s]))
        possible, expected = ({}, None) if why_not else ({"dilute gas": dilute}, float(average[s]))
        found.append(_intervals(name, tally, s, blocks, high[s], possible, expected))
    return window, found, why_not


def _free_flight_rates(
    log: Log, discs: Composition, start: float | None, end: float | None
) -> tuple[float, np.ndarray, np.ndarray, str]:
    """Temperature, collision rates (S, S) and mean speeds (S,) of free flights; why no law holds, empty if one does.

    Without a law they are means over the gas that only set the range of the histogram.
    """
    known = expectation(log, start, end)
    why_not = known.why_not
    if uneven := log.scene.lacking("uniform"):
        why_not = why_not or f"the gas is not the same everywhere ({', '.join(uneven)})"
    if log.scene.properties.thermostat_rate:
        why_not = why_not or "a heat bath changes velocities in flight"
    if known.ensemble and known.ensemble.dof < 2 * FEW:
        why_not = why_not or f"the law is that of many discs, and here are {len(log.discs)}"
    if known.ensemble and not why_not:
        gas = known.ensemble
        theory = theory_of(log, discs) if log.has_positions else None
        rates = expected_rates(discs, log.box, gas, theory).rate
        share = discs.mass * gas.temperature / gas.of_species
        if (rates.sum(axis=1) > 0).all():
            return gas.temperature, rates, mean_speed(gas.temperature, share, gas.dof), ""
        why_not = theory.why_not if theory and theory.why_not else "discs do not collide"
    time, collisions = log.observables["disc_collisions"]
    if not len(time) or not (collisions[-1] > collisions[0] and time[-1] > time[0]):
        raise UserError(f"{log.path}: too few collisions of discs for a distribution")
    rate = float(collisions[-1] - collisions[0]) / float(time[-1] - time[0]) / len(log.discs)
    return known.scale, np.diag(np.full(len(discs.name), rate)), mean_speed(known.scale, discs.mass), why_not


def _waiting_times(log: Log, start: float | None, end: float | None, progress: Progress) -> Found:
    longest = 20 * (log.end_time - log.start_time) / max(len(log), 1)  # a pair collision has two rows
    tally = WaitingTimes(np.array([longest]), BINS, max(STRIDE, len(log) // INTERVALS), 2 * INTERVALS)
    window = measure(log, [tally], start, end, progress)
    blocks = slice(window.first, len(tally.counts))
    why_not = nonstationary_reason(log)
    if log.has_positions and len(log.discs) < FEW:
        why_not = why_not or f"the law is that of many discs, and here are {len(log.discs)}"
    with np.errstate(divide="ignore", invalid="ignore"):
        law = distributions.WaitingTimeLaw(tally.counts[blocks].sum() / tally.sums[blocks].sum())
    possible = {} if why_not else {"exponential": law}
    return window, [_intervals("all discs", tally, 0, blocks, longest, possible, None)], why_not


def _intervals(
    name: str,
    tally: FreeFlights | WaitingTimes,
    s: int,
    blocks: slice,
    high: float,
    possible: Mapping[str, distributions.Law],
    expected: float | None,
) -> Distribution:
    counts = tally.counts[blocks, s].astype(float)
    chosen = (tally.sample_species == s) & (tally.sample_block >= blocks.start) & (tally.sample_block < blocks.stop)
    average = ratio(tally.sums[blocks, s], counts.sum(axis=1), theory=expected)
    edges = np.linspace(0, high, BINS + 1)
    return _distribution(name, edges, counts, average, tally.sample[chosen], None, possible)


def _distribution(
    name: str,
    edges: np.ndarray,
    counts: np.ndarray,
    average: Estimate,
    samples: np.ndarray,
    correlation_time: float | None,
    possible: Mapping[str, distributions.Law],
) -> Distribution:
    """Distribution from counts (B, bins + 2) of B blocks; the first and last bin count values outside the edges."""
    if not (total := counts.sum(axis=1)).any() or len(samples) == 0:
        raise UserError(f"too few events in the window for a distribution of {name}")
    share = counts[:, 1:-1].sum(axis=0) / total.sum()
    spread = counts[:, 1:-1] - share * total[:, None]
    error = np.sqrt(len(total) * spread.var(axis=0)) / total.sum()
    tests = []
    for law_name, law in possible.items():
        result = stats.kstest(samples, law.cdf)
        tests.append(Test(law_name, law, float(result.statistic), float(result.pvalue)))
    width = np.diff(edges)
    return Distribution(
        name, edges, share / width, error / width, average, len(samples), correlation_time, tuple(tests)
    )
