"""From when on a gas is steady: one test for all analyses, of the quantities that they average.

The later part of a log is taken as reference: its half or, where that tells nothing of a series, its last quarter. A
series is steady from a start on if the mean of every stretch that begins there agrees with the mean of the reference.
What stretches of any length scatter by is known from the autocovariances of the reference (`autoregression`), so that a
steady series passes whatever its correlations: one gas in a hundred fails for stretches of one length, and then loses
some of its start.
"""

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from scipy import special

from idealgas.analysis.core.autoregression import error_of_mean, is_constant, process_of, variance_of_mean
from idealgas.analysis.core.flights import DensityBins, Moments
from idealgas.analysis.core.impacts import Impacts
from idealgas.analysis.core.stream import Tally
from idealgas.log import Log

BINS = 4
"""Number of bins of the box along each axis in which the density is tested."""

REFERENCES = (2, 4)
"""Parts of a log whose last one is tried as reference: its last half, or its last quarter."""

FEWEST, LONG = 16, 64
"""Least number of blocks of a log that is tested, and of a part of it that is found to change."""

ENOUGH = 2.0
"""Least degrees of freedom of the last half; with fewer, slow change cannot be told from fluctuations."""

BEYOND = 16
"""Part of a log by which the steady part is longer than the last quarter if the last half has a trend; else a slow
drift would pass for steady."""

TREND = 1e-5
"""Probability that a steady gas is found to have a trend in the reference, roughly: slow fluctuations look like one."""

LEVEL = 0.01
"""Probability that a steady gas is found not to be steady, for stretches of one length."""

STARTS = 33
"""Number of evenly spaced starts that are tried, beside those each 1.4 times the one before."""

SHORTEST = 4
"""Number of blocks of the shortest stretch that is tested; each longer one is twice as long.

Of numbers of discs, whose largest scatter is known, single blocks are tested.
"""

FEWEST_SAMPLES = 4.0
"""Least number of independent samples with which a series counts as longer than its fluctuations."""

FORGOTTEN = 10.0
"""Correlation times after which a gas has forgotten its start: as much of it may be left as fluctuations hide."""

ROUNDING = 1e-9
"""Relative change below which a series is constant."""


class Course:
    """Course of a gas in blocks of time: the tallies to fill, and the series that are steady in equilibrium.

    They are kurtosis, kinetic energy and density in bins of each species, the virial and numbers of events.
    """

    def __init__(self, log: Log, present: Iterable[Tally] = ()) -> None:
        """Take the gas of a log; of the tallies that are `present` in an analysis those that fit are used."""
        present = list(present)
        self._present = present
        self._clusters = not log.scene.properties.lossless
        self.moments = next((t for t in present if isinstance(t, Moments)), None) or Moments(log.gravity)
        self.impacts: Impacts | None = None
        self.bins: DensityBins | None = None
        if log.has_positions:
            found = next((t for t in present if isinstance(t, Impacts)), None)
            self.impacts = found or Impacts(len(log.walls), log.periodic)
            self.bins = DensityBins(BINS)

    @property
    def tallies(self) -> list[Tally]:
        """All tallies to fill, those that were present first."""
        own = (tally for tally in (self.moments, self.impacts, self.bins) if tally is not None)
        return [*self._present, *(tally for tally in own if tally not in self._present)]

    def series(self) -> Iterator[np.ndarray]:
        """Series (B,) that are steady in equilibrium."""
        yield self.moments.flights[:, :, 3].sum(axis=1)
        yield from self.moments.flights[:, :, 1:3].reshape(len(self.moments.flights), -1).T
        yield from self.moments.events.T.astype(float)
        if self.impacts is not None:
            yield self.impacts.pair_virial

    def counts(self) -> Iterator[tuple[np.ndarray, float]]:
        """Numbers of discs (B,) at instants that are steady too, each with the number of all discs of its species.

        The number is infinite where discs form clusters, and their numbers scatter more than if each had a place of its
        own.
        """
        if self.bins is not None:
            for s in range(self.bins.discs.shape[1]):
                discs = self.bins.discs[:, s].reshape(len(self.bins.discs), -1)
                yield from ((one, math.inf if self._clusters else float(discs[0].sum() / 2)) for one in discs.T)


class Reference(NamedTuple):
    """Later part of a series, of n samples.

    first: index of the first sample. mean: of the samples. variance: (n,), variances of means of 1 to n samples. dof:
    degrees of freedom of these. trend: slope of the samples against time, in its standard errors.
    """

    first: int
    mean: float
    variance: np.ndarray
    dof: float
    trend: float

    def drifts(self, level: float) -> bool:
        """Whether the samples have a trend that chance gives with the probability `level`."""
        return self.trend > self.quantile(level)

    def quantile(self, level: float) -> float:
        """Deviation in standard errors that chance exceeds with the probability `level`, on either side."""
        return -float(special.stdtrit(self.dof, level / 2))


def steady_from(series: Iterable[np.ndarray], counts: Iterable[tuple[np.ndarray, float]] = ()) -> int | None:
    """Index from which on all series (n,) are steady; None if they still change at the end.

    counts: series of numbers at instants, each with the number from which it is drawn; infinite if they are not.
    """
    every = [*((values, math.inf) for values in series), *counts]
    varied = [(values, number) for values, number in every if np.ptp(values) > ROUNDING * np.abs(values).max()]
    some = [values for values, _ in varied]
    if not some or len(some[0]) < FEWEST:
        return 0
    n, level = len(some[0]), TREND / len(some)
    parts = [part for part in REFERENCES if n // part >= LONG or part == REFERENCES[0]]
    references, drifts = [], False
    for values in some:
        for part in parts:
            found = _reference(values, n - n // part)
            if found.drifts(level):
                drifts = True
            elif found.dof >= ENOUGH or part == parts[-1]:
                references.append(found)
                break
        else:
            return None if n // 2 >= LONG else n - n // 2
    last = max(r.first for r in references)
    start = _first_steady(varied, references, last)
    return None if drifts and last - start < n // BEYOND else start


def forgetting(series: Iterable[np.ndarray], first: int) -> int:
    """Number of samples in which all series (n,) forget their start, by their correlation times from `first` on."""
    longest = 0.0
    for values in series:
        part = values[first:]
        if np.ptp(part) > ROUNDING * np.abs(part).max():
            longest = max(longest, error_of_mean(part).error ** 2 * len(part) / (2 * part.var()))
    return math.ceil(FORGOTTEN * longest)


def unsteady(name: str, series: np.ndarray, time: np.ndarray) -> tuple[str, ...]:
    """Sentence on a series (n,) at times (n,) whose mean is taken though it is not known to be steady.

    A start of less than 1/BEYOND of it that does not agree with the rest changes no mean.
    """
    first, samples = steady_from([series]), error_of_mean(series).samples
    if first is not None and first > len(series) // BEYOND:
        return (
            f"{name} is not steady in the window: only from t = {time[first]:.4g} on do the means of its parts agree. "
            "It takes a later start or a longer run.",
        )
    if first is None or samples < FEWEST_SAMPLES:
        return (
            f"{name} changes as slowly as the window is long: its mean and error may be those of one fluctuation, or "
            "of a change that is not over. It takes a longer run.",
        )
    return ()


def _reference(series: np.ndarray, first: int) -> Reference:
    """Reference of the samples of a series from the first on."""
    values = series[first:]
    n = len(values)
    if is_constant(values):
        return Reference(first, float(values.mean()), np.zeros(n), math.inf, 0.0)
    time = np.arange(n) - (n - 1) / 2
    weight = time / (time @ time)
    slope = float(weight @ values)
    rest = values - values.mean() - slope * time
    if is_constant(rest):
        return Reference(first, float(values.mean()), np.zeros(n), math.inf, math.inf)
    process = process_of(rest)
    samples = process.spread().samples
    dof = max(samples - 2, 1.0)
    covariance = process.covariances(n) * samples / dof  # mean and slope have taken two of the samples
    overlaps = np.fft.irfft(np.abs(np.fft.rfft(weight, 2 * n)) ** 2, 2 * n)[:n]
    variance = covariance[0] * overlaps[0] + 2 * float(covariance[1:] @ overlaps[1:])
    scatter = np.maximum(variance_of_mean(covariance), 0.0)
    return Reference(first, float(values.mean()), scatter, dof, abs(slope) / math.sqrt(variance))


def _first_steady(series: list[tuple[np.ndarray, float]], references: list[Reference], last: int) -> int:
    """First start, of those that are tried, from which on all series agree with their references; at latest `last`.

    series: with the number from which a number of discs is drawn; that of independent discs has the largest scatter.
    """
    sums = [np.append(0.0, np.cumsum(values - r.mean)) for (values, _), r in zip(series, references, strict=True)]
    limits = [r.quantile(LEVEL / len(series)) ** 2 for r in references]
    beyond = special.ndtri(LEVEL / len(series) / 2) ** 2
    most = [
        math.inf if number == math.inf else beyond * r.mean * (1 - r.mean / number)
        for (_, number), r in zip(series, references, strict=True)
    ]

    def is_steady(start: int) -> bool:
        lengths = 2 ** np.arange(int(np.log2(last - start)) + 1)
        for total, r, limit, largest in zip(sums, references, limits, most, strict=True):
            shortest = SHORTEST if largest == math.inf else 1
            some = lengths[(lengths >= shortest) & (start + lengths <= r.first)]
            heads = (total[start + some] - total[start]) / some
            scatter = r.variance[np.minimum(some, len(r.variance)) - 1] + r.variance[-1]
            if (heads**2 > np.minimum(limit * scatter, largest + limit * r.variance[-1])).any():
                return False
        return True

    starts = np.unique([0, *2 ** (np.arange(2 * np.log2(last)) / 2), *np.linspace(0, last, STARTS)]).astype(int)
    return next((int(start) for start in starts if start < last and is_steady(int(start))), last)
