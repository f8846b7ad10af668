"""Distributions of speeds, energies, free flights and waiting times, with Kolmogorov-Smirnov tests of their laws.

Histograms of velocities weight every value with the time that discs spend at it; histograms of intervals count every
interval once. The tests use decorrelated samples: velocities of some discs at instants one correlation time apart, or
every n-th interval.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from idealgas.analysis.core.collisions import expected_rates, theory_of
from idealgas.analysis.core.composition import composition
from idealgas.analysis.core.equilibrium import ensemble
from idealgas.analysis.core.flights import VELOCITY_QUANTITIES, VelocityHistogram
from idealgas.analysis.core.intervals import FreeFlights, Waits
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, ensemble_inefficiency, mean, ratio
from idealgas.analysis.core.window import Window, measure
from idealgas.analysis.histogram import QUANTITIES
from idealgas.analysis.theory import distributions
from idealgas.analysis.theory.hard_discs import mean_speed
from idealgas.errors import UserError
from idealgas.gas.state import Gas
from idealgas.log import Log

BINS = 120
SAMPLED = 256  # largest number of discs of a species whose velocities are tested
INTERVALS = 10_000  # approximate number of intervals that are tested
FEWEST_SAMPLES = 30  # of a test; the distance that one in twenty correct laws exceeds is then 0.24
STRIDE = 7  # at least every 7th interval is a sample, as successive flights of a disc are correlated
TAIL = 12  # mean free times before the end of a window from which no flight is counted, as long ones would be cut off


@dataclass(frozen=True)
class Test:
    """Kolmogorov-Smirnov test of samples against a law.

    law_name: name of the law. law: the distribution. distance: largest difference of the distribution functions (no
    unit). p_value: probability of at least this distance by chance.
    """

    law_name: str
    law: distributions.Law
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

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        middle = (self.edges[1:] + self.edges[:-1]) / 2
        return {
            "name": self.name,
            "mean": self.mean.as_dict(),
            "samples": self.samples,
            "correlation_time": self.correlation_time,
            "tests": [{"law": t.law_name, "distance": t.distance, "p_value": t.p_value} for t in self.tests],
            "edges": self.edges.tolist(),
            "density": self.density.tolist(),
            "error": self.error.tolist(),
            "laws": {test.law_name: test.law.pdf(middle).tolist() for test in self.tests},
        }


@dataclass(frozen=True)
class Histogram(Result):
    """Distributions of one quantity (with its unit) in a window of time, one for each species."""

    quantity: str
    unit: str
    window: Window
    distributions: tuple[Distribution, ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        return super().as_dict() | {
            "quantity": self.quantity,
            "unit": self.unit,
            "window": self.window.as_dict(),
            "distributions": [distribution.as_dict() for distribution in self.distributions],
        }


Progress = Callable[[int, int], None] | None


def histogram(
    log: Log, quantity: str = "speed", start: float | None = None, end: float | None = None, progress: Progress = None
) -> Histogram:
    """Measure a distribution between two times of a log, species by species, and test it against its laws.

    quantity: speed, vx, vy or energy of a disc; free-path or free-time of a disc between two collisions with discs; or
    wait, the time between two successive events of the gas. The laws of velocities are Maxwell and Boltzmann's and that
    at fixed energy of N discs; of free flights that of a dilute gas; of waits the exponential one. The p-values are
    those of Kolmogorov and Smirnov's test of decorrelated samples.

    start, end: times; by default from detected equilibrium to the end of the log. progress(done, in all) is called as
    events are read. Raises UserError if no disc moves, if there are too few events in the window, or for a gas with
    effects for which there is no such law.
    """
    if not log.discs.temperature > 0:
        raise UserError(f"{log.path}: no disc moves")
    if quantity in VELOCITY_QUANTITIES:
        window, found = _velocities(log, quantity, start, end, progress)
    elif quantity == "wait":
        window, found = _waits(log, start, end, progress)
    else:
        window, found = _flights(log, quantity, start, end, progress)
    few = [
        f"The tests of {each.name} have {each.samples} decorrelated samples; with fewer than {FEWEST_SAMPLES} they can "
        "hardly fail."
        for each in found
        if each.samples < FEWEST_SAMPLES
    ]
    return Histogram(quantity, QUANTITIES[quantity], window, tuple(found), premises=tuple(few))


Found = tuple[Window, list[Distribution]]


# ── velocities ──


def velocity_laws(quantity: str, temperature: float, mass: float, dof: float) -> dict[str, distributions.Law]:
    """Laws of a velocity quantity: Maxwell-Boltzmann's, and that of an isolated gas with `dof` degrees of freedom.

    dof: D; infinite in a heat bath, where both are one.
    """

    def law(dof: float) -> distributions.Law:
        if quantity == "energy":
            return distributions.EnergyLaw(temperature, dof)
        if quantity == "speed":
            return distributions.SpeedLaw(temperature, mass, dof)
        return distributions.ComponentLaw(temperature, mass, dof)

    finite = {f"fixed energy, D = {dof}": law(dof)} if 3 < dof < np.inf else {}
    return {"Maxwell-Boltzmann": law(np.inf), **finite}


def _velocities(log: Log, quantity: str, start: float | None, end: float | None, progress: Progress) -> Found:
    gas, discs, equilibrium = log.discs, composition(log.discs), ensemble(log)
    thermal = np.sqrt(equilibrium.temperature / discs.mass)
    high = np.full(len(thermal), 12 * equilibrium.temperature) if quantity == "energy" else 5 * thermal
    low = -high if quantity in ("vx", "vy") else np.zeros_like(high)
    members = [_some_discs(gas, s) for s in range(len(thermal))]
    tally = VelocityHistogram(quantity, low, high, BINS, np.concatenate(members))
    window = measure(log, [tally], start, end, progress, ("conserves_energy",))
    parts = np.split(tally.snapshots[window.first :], np.cumsum([len(ids) for ids in members])[:-1], axis=1)
    found = []
    for s, (name, snapshots) in enumerate(zip(discs.name, parts, strict=True)):
        possible = velocity_laws(quantity, equilibrium.of_species[s], discs.mass[s], equilibrium.dof)
        spacing = int(np.ceil(ensemble_inefficiency(snapshots)))
        last_law = list(possible.values())[-1]
        found.append(
            _distribution(
                name,
                np.linspace(low[s], high[s], BINS + 1),
                window.of(tally.counts)[:, s],
                _mean(window.of(tally.sums)[:, s] / discs.number[s], high[s], last_law.mean),
                snapshots[::spacing].ravel(),
                spacing * window.width,
                possible,
            )
        )
    return window, found


def _mean(series: np.ndarray, scale: float, expected: float) -> Estimate:
    """Mean of a series of values of magnitude `scale`; a conserved quantity only varies by rounding, without error."""
    if np.ptp(series) < 1e-12 * scale:
        return Estimate(float(series.mean()), 0.0, 1.0, expected)
    return mean(series, theory=expected)


def _some_discs(gas: Gas, species: int) -> np.ndarray:
    """Discs whose velocities are sampled: at most a quarter of a species, as the total energy correlates velocities."""
    members = np.flatnonzero(gas.species == species)
    return members[:: max(4, -(-len(members) // SAMPLED))]


# ── intervals ──


def _flights(log: Log, quantity: str, start: float | None, end: float | None, progress: Progress) -> Found:
    gas, discs, equilibrium = log.discs, composition(log.discs), ensemble(log)
    temperature = equilibrium.temperature
    rates = expected_rates(discs, gas.box, equilibrium, theory_of(log, discs) if log.has_positions else None).rate
    rate = rates.sum(axis=1)
    if not (rate > 0).all():
        raise UserError(f"{log.path}: no law of free flights for this gas")
    path = quantity == "free-path"
    high = 10 / rate
    if path:
        high *= mean_speed(temperature, discs.mass)
    tally = FreeFlights(path, high, BINS, max(STRIDE, len(log) // INTERVALS), 2 * INTERVALS)
    window = measure(log, [tally], start, end, progress, ("uniform",))
    last = len(tally.counts) - int(np.ceil(TAIL / rate.min() / window.width))
    blocks = slice(window.first, max(last, (window.first + len(tally.counts)) // 2))
    law = distributions.FreePathLaw if path else distributions.FreeTimeLaw
    dilute = [law(temperature, discs.mass[s], tuple(discs.mass), tuple(rates[s])) for s in range(len(rate))]
    return window, [
        _intervals(name, tally, s, blocks, high[s], {"dilute gas": dilute[s]}, dilute[s].mean)
        for s, name in enumerate(discs.name)
    ]


def _waits(log: Log, start: float | None, end: float | None, progress: Progress) -> Found:
    longest = 20 * (log.end_time - log.start_time) / max(len(log), 1)  # a pair collision has two rows
    tally = Waits(np.array([longest]), BINS, max(STRIDE, len(log) // INTERVALS), 2 * INTERVALS)
    window = measure(log, [tally], start, end, progress)
    blocks = slice(window.first, len(tally.counts))
    with np.errstate(invalid="ignore"):
        law = distributions.WaitLaw(tally.counts[blocks].sum() / tally.sums[blocks].sum())
    return window, [_intervals("all discs", tally, 0, blocks, longest, {"exponential": law}, None)]


def _intervals(
    name: str,
    tally: FreeFlights | Waits,
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
