"""Window of time that an analysis uses: given by the user, or starting at the detected equilibrium.

The beginning of a run is compared with the remainder, as in the test of Heidelberger & Welch (Oper. Res. 31, 1109
(1983)). The standard errors follow from autoregressive models of the last blocks or, if these are smaller, from the
fluctuations in the known ensemble. As a transient can be as short as a few collisions per disc, the means of stretches
of 1, 2, 4, … blocks are compared for each observable.

Choosing the start that gives the largest effective number of samples (Chodera, J. Chem. Theory Comput. 12, 1799 (2016))
would also discard the transients, but in a quarter of the short runs of steady gases it discards more than a tenth.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from idealgas.fields import OMITTED, Key, as_dict, reported
from idealgas.log import Log
from idealgas.statistics.autoregression import error_of_mean, is_constant, process_of, variance_of_mean
from idealgas.tallies.equilibrium import ROUNDING, kind_of_state, known_ensemble, must_apply, must_be_shared, not_steady
from idealgas.tallies.exchange import NOTHING, Exchange, through_pistons
from idealgas.tallies.observables import Observable, TimeSeries
from idealgas.tallies.stream import Tally, block_edges, stream

LEAST_TESTED = 16
"""Smallest number of blocks that are searched for a transient."""

LEVEL = 0.1
"""Largest probability of discarding data of a steady gas; that of discarding ℓ blocks is proportional to 1/ℓ."""

REFERENCE = 64
"""Number of final blocks that determine the fluctuations, but at least the last quarter and at most half of them."""

STARTS = 33
"""Number of possible starts in the first half of the log, evenly spaced on a logarithmic scale."""

MARGIN = 2
"""Ratio of the start of the window to the time at which a transient becomes smaller than the fluctuations.

The transient does not end at this time but continues below the fluctuations.
"""

MEMORIES = 10.0
"""Number of correlation times after which a gas no longer depends on its initial positions.

It is used if the equilibrium of the gas is not known.
"""

FEWEST_SAMPLES = 4.0
"""Smallest number of independent samples in a series that is longer than its correlation time."""

_KNOWN: WeakKeyDictionary[Log, dict[tuple[int, float, float, bool], tuple[int, Exchange]]] = WeakKeyDictionary()
"""For each log, the first block of the steady state and the slowest exchange, by number of event rows and window."""


@dataclass(frozen=True)
class Window:
    """Blocks of equal width in time that were read from a log, and the first block that an analysis uses.

    Attributes:
        edges: (B + 1,), boundaries of the blocks, time.
        first: index of the first block that is used.
        detected: whether the start was detected.
        state: the detected state, "equilibrium" or "steady state"; see `kind_of_state`.
        slowest: slowest exchange in the gas; see `slowest_exchange`.
    """

    edges: Annotated[np.ndarray, OMITTED]
    first: Annotated[int, OMITTED]
    detected: Annotated[bool, Key("equilibration_detected")]
    state: Annotated[str, OMITTED] = "equilibrium"
    slowest: Annotated[Exchange, OMITTED] = NOTHING

    @property
    @reported
    def start(self) -> float:
        """Start of the window, time."""
        return float(self.edges[self.first])

    @property
    @reported
    def end(self) -> float:
        """End of the window, time."""
        return float(self.edges[-1])

    @property
    def duration(self) -> float:
        """Length of the window, time."""
        return self.end - self.start

    @property
    def width(self) -> float:
        """Width of one block, time."""
        return float(self.edges[1] - self.edges[0])

    @property
    def memory(self) -> float:
        """Number of blocks per independent block, according to the slowest exchange."""
        return self.slowest.time / self.width

    def of(self, sums: np.ndarray) -> np.ndarray:
        """Return the sums (B, …) of a tally in the blocks of the window, divided by the width of a block."""
        return sums[self.first :] / self.width

    def __str__(self) -> str:
        """Return a line with start and end, and how the start was chosen."""
        how = f"from detected {self.state}" if self.detected else "as asked"
        return f"window: t = {self.start:.6g} to {self.end:.6g} ({how})"

    def as_dict(self) -> dict[str, Any]:
        """Return the window as plain values by name, ready for JSON."""
        return as_dict(self)

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> "Window":
        """Restore a window, as a single block of time, from its plain values."""
        edges = np.array([values["start"], values["end"]], float)
        return cls(edges, first=0, detected=bool(values["equilibration_detected"]))


def measure(
    log: Log,
    tallies: Sequence[Tally],
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    needs: Sequence[str] = (),
) -> Window:
    """Read the events of a log between two times into tallies, and return the window of time to use.

    If no start is given, the window begins at the detected equilibrium, at the same time for all analyses of a log.

    Args:
        log: the log to read.
        tallies: sums to collect over the events.
        start: start of the window, time; None for the detected equilibrium.
        end: end of the window, time; None for the end of the log.
        progress: called as progress(done, total), with numbers of event rows.
        needs: properties of the scene (`idealgas.effects.properties`) that the analysis requires.

    Raises:
        UserError: if the log has no events in the window, if the scene lacks a required property, or if the gas does
            not become steady.
    """
    must_apply(log, start, needs)
    edges, detected = block_edges(log, start, end), start is None
    known = _KNOWN.setdefault(log, {})
    key = (len(log), edges[0], edges[-1], detected)
    if key not in known:
        series, first = TimeSeries(log, edges, tallies), 0
        stream(log, edges, series.tallies, progress)
        if detected:
            first = equilibrated_from(log, edges, [*series.observables(), *series.centres()])
            must_be_shared(log, series.rates[first:, :, 1:])
        known[key] = first, max(series.slowest_exchange(first), through_pistons(log))
    elif tallies:
        stream(log, edges, tallies, progress)
    first, slowest = known[key]
    return Window(edges, first, detected, kind_of_state(log), slowest)


# ── detection ──


class _Series(NamedTuple):
    """Series of n blocks and its fluctuations, which are determined from the last r blocks, the reference.

    Attributes:
        sums: (n + 1,), running sums of the deviations from the mean of the reference.
        variance: (r,), variances of the means of 1 to r blocks.
        dof: number of degrees of freedom of the variance of the mean of many blocks.
        memory: number of blocks per independent block.
        most: theoretical upper bound on the variance of a mean.
    """

    sums: np.ndarray
    variance: np.ndarray
    dof: float
    memory: float
    most: float

    def agrees(self, start: int, level: float, floor: float = 0.0) -> bool:
        """Return whether the mean of every stretch that begins at `start` agrees with the later half of the remainder.

        The variance of a mean over few blocks has more degrees of freedom than that over many blocks: one for each such
        stretch in the reference. A steady series fails the test with probability `level`: half of this in the stretch
        of one block, a quarter in that of two blocks, and so on. The variance of a difference is at least `floor`.
        """
        from scipy import special

        n, known = len(self.sums) - 1, len(self.variance)
        middle = (start + n) // 2
        lengths = 2 ** np.arange((middle - start).bit_length())
        mean = (self.sums[n] - self.sums[middle]) / (n - middle)
        difference = (self.sums[start + lengths] - self.sums[start]) / lengths - mean
        single, later = self.variance[np.minimum(lengths, known) - 1], self.variance[min(n - middle, known) - 1]
        dof = np.maximum(self.dof, known / np.maximum(lengths, self.memory) - 1)
        chance = level / lengths / 4  # half of the level, divided between the two tails
        by_series = special.stdtrit(dof, chance) ** 2 * np.maximum(single + later, floor)
        by_theory = special.ndtri(chance) ** 2 * (self.most + min(later, self.most))
        return bool((difference**2 <= np.minimum(by_series, by_theory)).all())


def detect_equilibration(series: Iterable[Observable]) -> int | None:
    """Return the index after which all series are steady; None if there is no such index in their first half."""
    varied = [item for item in series if np.ptp(item.values) > ROUNDING * np.abs(item.values).max()]
    if not varied or (n := len(varied[0].values)) < LEAST_TESTED:
        return 0
    level, half = LEVEL / len(varied), n // 2
    tested = [(_tested(item, max(n // 4, min(half, REFERENCE))), item.least) for item in varied]
    informative = [item for item, least in tested if not least or not item.agrees(0, level, least)]
    starts = np.unique(np.append(0, np.geomspace(1, half, STARTS).astype(int)))
    for start in starts.tolist():
        if all(item.agrees(start, level) for item in informative):
            return min(MARGIN * start, half)
    return None


def _tested(observable: Observable, reference: int) -> _Series:
    """Return the series to be tested, with the fluctuations of its last `reference` blocks about a linear trend."""
    values = observable.values
    last = values[len(values) - reference :]
    sums = np.append(0.0, np.cumsum(values - last.mean()))
    time = np.arange(reference) - (reference - 1) / 2
    residual = last - last.mean() - time * float(time @ last) / float(time @ time)
    rounding = (ROUNDING * float(np.abs(values).max())) ** 2
    if is_constant(residual):
        return _Series(sums, np.full(reference, rounding), math.inf, 1.0, observable.most)
    process = process_of(residual)
    samples = process.spread().samples
    dof = max(samples - 2, 1.0)
    covariance = process.covariances(reference) * samples / dof  # mean and trend use two degrees of freedom
    variance = np.maximum(variance_of_mean(covariance), rounding)
    return _Series(sums, variance, dof, max(reference * variance[-1] / covariance[0], 1.0), observable.most)


def memory_time(series: Iterable[np.ndarray]) -> float:
    """Return the longest correlation time among several series (n,), in numbers of samples."""
    varied = [values for values in series if np.ptp(values) > ROUNDING * np.abs(values).max()]
    return max((error_of_mean(x).error ** 2 * len(x) / (2 * x.var()) for x in varied), default=0.0)


def unsteady(name: str, series: np.ndarray, time: np.ndarray) -> tuple[str, ...]:
    """Return a caveat if a series (n,) at times (n,), which is averaged, is not steady after its first tenth."""
    first, samples = detect_equilibration([Observable(series)]), error_of_mean(series).samples
    if first is not None and first > len(series) // 10:
        return (
            f"{name} is not steady in the window: the means of its parts agree only after t = {time[first]:.4g}. "
            "Use a later start or a longer run.",
        )
    if first is None or samples < FEWEST_SAMPLES:
        return (
            f"{name} changes too slowly for this window: its mean and error may describe a single fluctuation, or "
            "a change that has not ended. Use a longer run.",
        )
    return ()


# ── steady part of a log ──


def equilibrated_from(log: Log, edges: np.ndarray, series: Iterable[Observable]) -> int:
    """Return the index of the first block, after the last change in the scene, at which all series are steady.

    If the equilibrium of the gas is not known, the index is at least MEMORIES correlation times later.

    Args:
        log: log of the gas.
        edges: (B + 1,), boundaries of the blocks, or times of B samples.
        series: observables in the B blocks.

    Raises:
        NotApplicableError: if the series do not become steady.
    """
    begin = after_changes(log, edges)
    steady = [item._replace(values=item.values[begin:]) for item in series]
    first = detect_equilibration(steady)
    if first is None:
        raise not_steady(log, "the gas still changes in the second half of the log")
    if known_ensemble(log) is None:
        memory = math.ceil(MEMORIES * memory_time(item.values[first:] for item in steady if not item.least))
        first = max(first, min(memory, len(steady[0].values) // 2))
    return begin + first


def after_changes(log: Log, edges: np.ndarray) -> int:
    """Return the index of the first block after the last change in the scene; 0 if the scene does not change.

    edges: (B + 1,), boundaries of the blocks, time.

    Raises:
        NotApplicableError: if too few blocks follow the last change.
    """
    changes = [time for time in log.scene.properties.changes if edges[0] < time < edges[-1]]
    if not changes:
        return 0
    begin = int(np.searchsorted(edges, max(changes)))
    if begin > len(edges) - 1 - LEAST_TESTED:
        raise not_steady(log, f"the scene changes at t = {max(changes):g}, with too little of the log after it")
    return begin
