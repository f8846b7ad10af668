"""Order of discs: hexagonal order of neighbours, its correlation, structure factor and positional order."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from idealgas.analysis.core.bond_order import FOLD, bond_order
from idealgas.analysis.core.equilibration import Window, measure, unsteady
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.samples import sampled
from idealgas.analysis.core.statistics import Estimate, mean
from idealgas.analysis.order.structure import Structure, WaveVectors
from idealgas.analysis.theory import hard_discs
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import Log

FRAMES, FEWEST_FRAMES = 128, 8
"""Number of instants of the whole log at which the order is measured, and least number of them in the window."""

MOST_WAVES = 2**28
"""Largest number of discs squared times frames: of a large gas fewer instants are taken, at least FEWEST_FRAMES."""

MOST_PAIRS = 2**19
"""Largest number of pairs of an instant for g₆(r): of a large gas some discs are taken, with all others around them."""

BINS_A_SPACING = 8
"""Bins of g₆(r) in a mean distance 1/√n between discs."""


@dataclass(frozen=True)
class Order(Result):
    """Order of the discs of one log (no unit, but for times and lengths).

    window: the time that was used. frames: number of instants in it. local: mean |ψ₆| of a disc. whole: |Ψ₆|, size of
    the mean of ψ₆ over all discs. square: N ⟨|Ψ₆|²⟩, the number of discs that turn together. hexagons: share of the
    discs with six neighbours. time, series: (F,), instants from the start of the log on, and |Ψ₆| there. distance,
    correlation, correlation_error: (B,), distance in the middle of a bin, length, g₆ = ⟨Re ψ₆*(0) ψ₆(r)⟩ of two discs
    so far apart, and its standard error. structure: structure factor; None unless the box is periodic.
    compressibility: limit of S(k) at small k by theory, nT times the isothermal compressibility; None without a theory.
    """

    window: Window
    frames: int
    local: Estimate
    whole: Estimate
    square: Estimate
    hexagons: Estimate
    time: np.ndarray
    series: np.ndarray
    distance: np.ndarray
    correlation: np.ndarray
    correlation_error: np.ndarray
    structure: Structure | None
    compressibility: float | None


def order(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Order:
    """Measure how well the discs of a gas are ordered between two times of its log.

    The order ψ₆ of the neighbours of each disc (`bond_order`), of all discs together and of two at a distance; in a
    periodic box the structure factor S(k), with its limit at small k by theory for a fluid of equal discs. All discs
    count alike, whatever their radius; walls inside the box do not part neighbours. Of a log without events the
    instants are its checkpoints.

    start, end: times; by default from detected equilibrium to the end of the log. progress(done, in all) is called as
    states are read. Raises UserError without positions or with a piston, or if the window is empty or has too few
    checkpoints.
    """
    if not log.has_positions:
        raise NotApplicableError(f"{log.path}: discs of this method have no positions")
    window, times = _instants(log, start, end)
    first = int(times.searchsorted(window.start))
    number, waves = len(log.discs), WaveVectors(log.box, len(log.discs))
    bins = _Distances(log)
    found, factors = [], []
    for k, state in enumerate(log.frames(times)):
        local, neighbours = bond_order(state.position, log.box, log.periodic)
        found.append((np.abs(local).mean(), np.abs(local.mean()), (neighbours == FOLD).mean()))
        if k >= first:
            bins.add(state.position, local)
            factors += [waves.structure_factor(state.position)] if all(log.periodic) else []
        if progress is not None:
            progress(k + 1, len(times))
    size, whole, six = np.array(found).T
    distance, correlation, error = bins.correlation()
    return Order(
        window=window,
        frames=len(times) - first,
        local=mean(size[first:]),
        whole=mean(whole[first:]),
        square=mean(number * whole[first:] ** 2),
        hexagons=mean(six[first:]),
        time=times,
        series=whole,
        distance=distance,
        correlation=correlation,
        correlation_error=error,
        structure=waves.structure(np.array(factors), number) if factors else None,
        compressibility=_compressibility(log),
        caveats=unsteady("|Ψ₆| of all discs", whole[first:], times[first:]),
    )


def _instants(log: Log, start: float | None, end: float | None) -> tuple[Window, np.ndarray]:
    """Window of time, and instants from the start of the log, or the given one, to its end."""
    number = max(min(FRAMES, MOST_WAVES // len(log.discs) ** 2), FEWEST_FRAMES)
    if log.has_events:
        window = measure(log, [], start, end, needs=("fixed_walls",))
        times = np.linspace(window.edges[0], window.end, number)
        if (times >= window.start).sum() < FEWEST_FRAMES:
            times = np.append(times[times < window.start], np.linspace(window.start, window.end, FEWEST_FRAMES))
        return window, times
    window, _ = sampled(log, start, end, ("fixed_walls",))
    known = log.checkpoints.times
    known = known[(known >= window.edges[0]) & (known <= window.end)]
    times = known[np.unique(np.linspace(0, len(known) - 1, number).astype(int))] if len(known) else known
    if (inside := int((times >= window.start).sum())) < FEWEST_FRAMES:
        few = f"only {inside} checkpoints between t = {window.start:g} and {window.end:g} (allowed >= {FEWEST_FRAMES})"
        raise UserError(f"{log.path}: has no events, and {few}")
    return window, times


def _compressibility(log: Log) -> float | None:
    """Limit of S(k) at small k, 1/(d(φZ)/dφ), of a fluid of equal discs in a periodic box; None for other gases."""
    gas, phi = log.discs, log.discs.packing_fraction
    if not all(log.periodic) or np.ptp(gas.radius) > 0 or phi > hard_discs.HIGHEST:
        return None
    return 1 / float(hard_discs.inverse_compressibility(phi))


class _Distances:
    """Sums of Re ψ₆*(0) ψ₆(r) over pairs of discs, by distance up to half of the box's shorter side."""

    def __init__(self, log: Log) -> None:
        number = len(log.discs)
        self._box, self._periodic = log.box, log.periodic
        self._reach, spacing = min(log.box) / 2, math.sqrt(log.discs.area / number)
        self._bins = max(int(BINS_A_SPACING * self._reach / spacing), 1)
        self._chosen = np.arange(0, number, -(-(number**2) // MOST_PAIRS))
        self._sums: list[np.ndarray] = []

    def add(self, position: np.ndarray, local: np.ndarray) -> None:
        """Add the pairs of an instant with positions (N, 2) and the order ψ₆ (N,) of each disc."""
        squared = np.zeros((len(self._chosen), len(position)))
        for place, size, periodic in zip(position.T, self._box, self._periodic, strict=True):
            apart = place[self._chosen, None] - place
            squared += (apart - size * np.round(apart / size) if periodic else apart) ** 2
        bins = np.minimum(np.sqrt(squared) * (self._bins / self._reach), self._bins).astype(np.int64)
        bins[np.arange(len(self._chosen)), self._chosen] = self._bins  # a disc is no pair with itself
        products = sum(part[self._chosen, None] * part for part in (local.real, local.imag))
        sums = (np.bincount(bins.ravel(), weights, self._bins + 1) for weights in (products.ravel(), None))
        self._sums.append(np.array([each[: self._bins] for each in sums]))

    def correlation(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Middle of each bin that mostly has pairs in it, mean of the product there, and its standard error."""
        product, pairs = np.moveaxis(np.array(self._sums), 1, 0)
        middle = (np.arange(self._bins) + 0.5) * (self._reach / self._bins)
        some = (pairs > 0).mean(axis=0) > 0.5  # a product that is rarely observed has no known error
        value = product.sum(axis=0)[some] / pairs.sum(axis=0)[some]
        influence = (product[:, some] - value * pairs[:, some]) / pairs[:, some].mean(axis=0)
        error = np.array([mean(column).standard_error for column in influence.T])
        return middle[some], value, error
