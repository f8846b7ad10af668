"""Measure the distribution of a quantity and test it against theory.

Velocities and energies are weighted by the time that discs spend at each value. Waiting times are the times between
successive events in the whole gas. Impact parameters are those of collisions between discs. Collisions are counted for
each disc in ten mean free times. The Kolmogorov-Smirnov tests use independent samples.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from idealgas.analysis.analysis import Analysis, Option, Section
from idealgas.analysis.check import VERDICTS
from idealgas.analysis.histogram.distribution import ALL_DISCS, BINS, Distribution, distribution_of
from idealgas.analysis.histogram.intervals import (
    Found,
    collision_counts,
    free_flights,
    impact_parameters,
    waiting_times,
)
from idealgas.analysis.histogram.laws import expectation, velocity_laws
from idealgas.analysis.result import Result
from idealgas.log import Log
from idealgas.presentation.tables import Cell, Number, Table, bars, estimates, format_estimate
from idealgas.statistics.autoregression import inefficiency
from idealgas.statistics.estimates import Estimate, mean, mean_of_flux
from idealgas.tallies.equilibration import Window, measure
from idealgas.tallies.equilibrium import ROUNDING, nonstationary_reason
from idealgas.tallies.flights import VELOCITY_QUANTITIES, Moments, VelocityHistogram
from idealgas.tallies.stream import ReadProgress
from idealgas.theory.conserved import degrees_of_freedom
from idealgas.theory.ensemble import composition, ensemble_at

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Quantity = Literal[
    "speed", "vx", "vy", "energy", "free-path", "free-time", "waiting-time", "impact-parameter", "collisions"
]
QUANTITIES: dict[Quantity, str] = {
    "speed": "length/time",
    "vx": "length/time",
    "vy": "length/time",
    "energy": "energy",
    "free-path": "length",
    "free-time": "time",
    "waiting-time": "time",
    "impact-parameter": "no unit",
    "collisions": "no unit",
}
"""Quantities whose distribution can be measured, with their units."""

INVERSE = {"length/time": "time/length", "no unit": "no unit"}
"""Units of densities that are not written as 1/unit, by unit of the quantity."""

OTHERS = {"waiting-time": waiting_times, "impact-parameter": impact_parameters, "collisions": collision_counts}
"""Functions that measure the distribution of a quantity, by quantity."""

LINES = 24  # number of lines of the text histogram; bins are merged to fit
SAMPLED = 1024  # largest number of discs of a species whose velocities are tested

GROUPS = 16
"""Number of groups of discs that are sampled in turn.

As the discs share a fixed energy and momentum, samples of all discs would be correlated; samples of a sixteenth of them
hardly are. A disc is sampled again only after sixteen statistical inefficiencies, by which time its velocity is hardly
correlated with its earlier value, even if the disc is confined between walls.
"""


@dataclass(frozen=True)
class Histogram(Result):
    """Distributions of one quantity in a time window, one for each species or one for the whole gas.

    Attributes:
        quantity: name of the quantity.
        unit: unit of the quantity.
        window: time window.
        distributions: distribution for each species, or for the whole gas.
        no_law: why theory predicts no distribution, as part of a sentence; None if it predicts one.
    """

    quantity: str
    unit: str
    window: Window
    distributions: tuple[Distribution, ...]
    no_law: str | None = None

    def plain_tables(self) -> list[Table]:
        """Return the tables of means, of cumulants if there are any, and of Kolmogorov-Smirnov tests."""
        tests: list[tuple[Cell, ...]] = []
        for distribution in self.distributions:
            spacing = Number(distribution.correlation_time, ".4g")
            for test in distribution.tests:
                distance, error = Number(test.distance, ".4f"), Number(test.law_error, ".2g")
                p, samples = Number(test.p_value, ".3g"), Number(distribution.samples, "d")
                tests.append(
                    (distribution.name, test.law_name, distance, error, p, samples, spacing, VERDICTS[test.agrees])
                )
        means = [(distribution.name, distribution.mean) for distribution in self.distributions]
        notes = (
            str(self.window),
            *(f"{each.name}: in t = {each.counted_in:.4g}" for each in self.distributions if each.counted_in),
            *([f"Theory is not available: {self.no_law}."] if self.no_law else []),
        )
        tables = [estimates(f"Mean {_in_words(self.quantity)} ({self.unit})", means, notes)]
        cumulants = [
            (f"{distribution.name}: {name.replace('_', ' ')}", estimate)
            for distribution in self.distributions
            for name, estimate in distribution.cumulants.items()
        ]
        tables += [estimates("Cumulants (no unit)", cumulants)] if cumulants else []
        if tests:
            columns_of_tests = ("", "law", "distance", "law's error", "p", "samples", "spacing (time)", "verdict")
            tables.append(Table("Kolmogorov-Smirnov tests (no unit)", columns_of_tests, tests))
        return tables

    def summary(self) -> str:
        """Return the mean for each species, and whether its distribution agrees with the laws."""
        sentences = [_follows(self, distribution) for distribution in self.distributions]
        return " ".join([*sentences, *([f"Theory is not available: {self.no_law}."] if self.no_law else [])])

    def text(self) -> str:
        """Return a text histogram for each species, with the first of its laws."""
        lines = []
        for distribution in self.distributions:
            groups, widths = np.array_split(np.arange(len(distribution.density)), LINES), np.diff(distribution.edges)
            curves = [distribution.density, *(test.law.pdf(distribution.middles) for test in distribution.tests[:1])]
            measured, *law = [
                [float(np.average(curve[group], weights=widths[group])) for group in groups] for curve in curves
            ]
            mark = f"; │ {distribution.tests[0].law_name}" if distribution.tests else ""
            lows = [float(distribution.edges[group[0]]) for group in groups]
            lines += [
                f"{distribution.name}: {self.quantity} ({self.unit}){mark}",
                bars(lows, measured, law[0] if law else None),
            ]
        return "\n".join(lines)

    def figure(self) -> "Figure":
        """Draw the measured density with error bars and the laws, in one panel per species."""
        from idealgas.presentation.style import COLOURS, GREY, panels

        figure, axes = panels(len(self.distributions))
        for ax, distribution in zip(axes, self.distributions, strict=True):
            name = f"{distribution.name} (no law)" if self.no_law else distribution.name
            ax.stairs(distribution.density, distribution.edges, fill=True, color=COLOURS[5], alpha=0.6, label=name)
            ax.errorbar(
                distribution.middles, distribution.density, distribution.error, fmt="none", ecolor=GREY, elinewidth=0.8
            )
            x = np.linspace(distribution.edges[0], distribution.edges[-1], 600)
            for test, colour, style in zip(distribution.tests, COLOURS, ("-", "--"), strict=False):
                ax.plot(x, test.law.pdf(x), style, color=colour, label=f"{test.law_name}: KS p = {test.p_value:.2g}")
            last = np.flatnonzero(distribution.density >= 1e-3 * distribution.density.max())[-1]
            ax.set_xlim(distribution.edges[0], distribution.edges[last + 1])
            ax.set_xlabel(f"{self.quantity} ({self.unit})")
            ax.set_ylabel(f"density ({INVERSE.get(self.unit, f'1/{self.unit}')})")
            ax.legend()
        ends, heights = (np.array([getattr(ax, of)() for ax in axes]) for of in ("get_xlim", "get_ylim"))
        for ax in axes:  # equal axes, so that species can be compared by eye
            ax.set(xlim=(ends[:, 0].min(), ends[:, 1].max()), ylim=(0, heights[:, 1].max()))
        return figure


class HistogramAnalysis(Analysis):
    """Distributions of speeds, energies, free flights, waiting times, impact parameters and numbers of collisions."""

    position = 50
    headline = "distributions.*.mean"
    results = (Histogram,)
    sections = tuple(
        Section(
            title,
            f"Density of {title.lower()}: measured with standard errors, and predicted by theory (lines)",
            {"quantity": quantity},
        )
        for title, quantity in (
            ("Speeds", "speed"),
            ("Velocities along x", "vx"),
            ("Energies", "energy"),
            ("Free paths", "free-path"),
            ("Free times", "free-time"),
            ("Waiting times between events", "waiting-time"),
            ("Impact parameters", "impact-parameter"),
            ("Numbers of collisions of a disc", "collisions"),
        )
    )
    options = (
        Option(
            "quantity",
            str,
            "Quantity whose distribution is measured. Free flights are those between collisions with discs, impact "
            "parameters are relative to the sum of the radii, and collisions are counted in ten mean free times.",
            default="speed",
            choices=tuple(QUANTITIES),
        ),
    )

    @staticmethod
    def measure(
        log: Log,
        quantity: Quantity = "speed",
        start: float | None = None,
        end: float | None = None,
        progress: ReadProgress | None = None,
    ) -> Histogram:
        """Measure the distribution of a quantity in a time window, for each species, and test it against theory.

        Velocities are compared with the Maxwell-Boltzmann distribution and that of N discs at fixed energy, free
        flights with the law of a dilute gas, waiting times with an exponential distribution, impact parameters with a
        uniform distribution, and numbers of collisions with the Boltzmann equation for a tagged disc in a dilute gas of
        equal discs. `law_error` is the largest error of the theoretical distribution function. The p-values are those
        of Kolmogorov-Smirnov tests of independent samples. Under gravity or with a piston of finite mass, the law is
        evaluated at the measured temperature. For a gas that never reaches equilibrium, theory is not available, and
        the window is the whole log by default.

        Raises:
            UserError: if no disc moves, or if the window contains too few events.
        """
        if start is None and nonstationary_reason(log):
            start = log.start_time
        if quantity in VELOCITY_QUANTITIES:
            window, distributions, no_law = _velocities(log, quantity, start, end, progress)
        elif quantity in ("free-path", "free-time"):
            window, distributions, no_law = free_flights(log, quantity, start, end, progress)
        else:
            window, distributions, no_law = OTHERS[quantity](log, start, end, progress)
        rows = sum(len(each.tests) for each in distributions)
        judged = tuple(each.judged(rows) for each in distributions)
        return Histogram(quantity, QUANTITIES[quantity], window, judged, no_law or None)


def _in_words(quantity: str) -> str:
    """Return the name of a quantity in words, in the singular."""
    return "number of collisions" if quantity == "collisions" else quantity.replace("-", " ")


def _follows(result: Histogram, distribution: Distribution) -> str:
    """Return a sentence on the mean of a distribution and on its agreement with the laws."""
    whose = "All discs" if distribution.name == ALL_DISCS else f"Species '{distribution.name}'"
    mean = f"{whose}: mean {_in_words(result.quantity)} {format_estimate(distribution.mean)}"
    words = {
        True: ("its distribution agrees with ", " and with "),
        False: ("its distribution differs from ", " and from "),
        None: (f"too few samples ({distribution.samples}) to tell whether its distribution agrees with ", " or "),
    }
    verdicts = [
        begin
        + between.join(
            f"{test.law_name} (p = {test.p_value:.2g})" for test in distribution.tests if test.agrees is verdict
        )
        for verdict, (begin, between) in words.items()
        if any(test.agrees is verdict for test in distribution.tests)
    ]
    return f"{'; '.join([mean, *verdicts])}."


def _velocities(
    log: Log, quantity: str, start: float | None, end: float | None, progress: ReadProgress | None
) -> Found:
    gas, discs, known = log.discs, composition(log.discs), expectation(log, start, end)
    lightest = np.full(len(discs.mass), np.inf)
    np.minimum.at(lightest, gas.species, gas.mass)
    thermal = np.sqrt(known.scale / lightest)
    high = np.full(len(thermal), 12 * known.scale) if quantity == "energy" else 5 * thermal
    low = -high if quantity in ("vx", "vy") else np.zeros_like(high)
    members = [np.flatnonzero(gas.species == s) for s in range(len(thermal))]
    members = [ids[np.argsort(gas.mass[ids], kind="stable")] for ids in members]
    members = [ids[:: -(-len(ids) // SAMPLED)] for ids in members]  # discs of all masses
    tally = VelocityHistogram(quantity, low, high, BINS, np.concatenate(members), log.gravity)
    moments = [Moments(log.gravity)] if known.needs_temperature else []
    window = measure(log, [tally, *moments], start, end, progress)
    measured = None
    if moments:
        energy = float(window.of(moments[0].flights)[:, :, 1:3].sum(axis=(1, 2)).mean())  # twice the kinetic energy
        measured = ensemble_at(log.scene, gas, energy / degrees_of_freedom(log.scene, log.discs), np.inf)
    parts = np.split(tally.snapshots[window.first :], np.cumsum([len(ids) for ids in members])[:-1], axis=1)
    confined = quantity in ("vx", "vy") and log.has_positions and not log.periodic["xy".index(quantity[1])]
    sums, densities, histograms = window.of(tally.sums), window.of(tally.counts), []
    for s, (name, snapshots) in enumerate(zip(discs.name, parts, strict=True)):
        possible = velocity_laws(quantity, known, s, measured)
        samples, spacing = independent_samples(snapshots)
        expected = list(possible.values())[-1].mean if possible and measured is None else None
        average = _mean(sums[:, s] / discs.number[s], high[s], expected, confined)
        edges = np.linspace(low[s], high[s], BINS + 1)
        histograms.append(
            distribution_of(name, edges, densities[:, s], average, samples, spacing * window.width, possible)
        )
    return window, histograms, known.reason


def _mean(series: np.ndarray, scale: float, expected: float | None, confined: bool) -> Estimate:
    """Return the mean of a series.

    Args:
        series: (B,), values at successive times.
        scale: magnitude of the values.
        expected: theoretical mean; None without theory.
        confined: whether the values are components of the velocity normal to walls that confine the gas.
    """
    if np.ptp(series) < 1e-12 * scale:  # conserved, except for rounding errors
        return Estimate(float(series.mean()), 0.0, 1.0, expected)
    if confined:
        return mean_of_flux(series, np.zeros(len(series)), expected)
    return mean(series, theory=expected)


def independent_samples(values: np.ndarray) -> tuple[np.ndarray, int]:
    """Return independent samples (n,) from values (B, M) of M discs at B times, and the spacing between samples.

    The spacing is a number of time steps: the largest statistical inefficiency of single discs and of their mean, which
    fluctuates slowly if walls or a thermostat exchange energy with the gas. The squares of the values are considered as
    well, because a light disc among heavy discs keeps its speed for longer than its direction.
    """
    memory = 1.0
    for x in (values, values**2):
        mean = x.mean(axis=1)
        conserved = np.ptp(mean) <= ROUNDING * np.abs(x).max()
        memory = max(memory, inefficiency(x), 1.0 if conserved else inefficiency(mean))
    spacing, groups = math.ceil(memory), min(GROUPS, values.shape[1])
    samples = [row[k % groups :: groups] for k, row in enumerate(values[::spacing])]
    return np.concatenate(samples), spacing
