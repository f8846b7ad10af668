"""Measure the order of the discs: ψ₆ of neighbours, its correlation g₆(r) and the structure factor S(k).

ψ₆ measures how closely the neighbours of a disc form a regular hexagon. The modulus of its mean over all discs is 1 in
a crystal and of order 1/√N in a fluid. S(k), which requires a periodic box, shows how regularly discs form rows; theory
predicts its limit at small k from the compressibility. A run without events is measured at its checkpoints.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.result import Result
from idealgas.errors import NotApplicableError, UserError
from idealgas.fields import OMITTED, Key
from idealgas.log import Log
from idealgas.presentation.tables import Number, Table, estimates, format_estimate, with_error
from idealgas.statistics.estimates import Estimate, mean
from idealgas.tallies.bond_order import DENSE, FOLD, bond_order
from idealgas.tallies.equilibration import Window, measure, unsteady
from idealgas.tallies.samples import sampled
from idealgas.tallies.stream import ReadProgress, frames
from idealgas.theory import hard_discs

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FRAMES, FEWEST_FRAMES = 128, 8
"""Number of instants in the whole log at which the order is measured, and the smallest number in the window."""

MOST_WAVES = 2**28
"""Largest N² times the number of frames; a large gas is measured at fewer instants, at least FEWEST_FRAMES."""

MOST_PAIRS = 2**19
"""Largest number of pairs per instant for g₆(r); in a large gas only some discs are paired with all the others."""

BINS_A_SPACING = 8
"""Number of bins of g₆(r) per mean distance 1/√n between discs."""

MOST_ROWS = 12
"""Largest number of rows printed for a function of distance or wave number; the CSV file contains all rows."""

REACH = 15.0
"""Largest wave number in units of √n; the first peaks of a triangular lattice lie at 6.75, 11.7 and 13.5."""

RINGS = 60
"""Number of rings into which the wave vectors are divided; S(k) is averaged over the directions in each ring."""


@dataclass(frozen=True)
class Structure:
    """Structure factor of the discs in a periodic box (no unit).

    Attributes:
        kx, ky: (X,) and (Y,), components of the wave vectors, 1/length; kx ≥ 0, as S(-k) = S(k).
        on_lattice: (X, Y), mean of S over time at each wave vector; nan for those that are not used.
        k, value, error: (K,), mean wave number of each ring, S averaged over time and over the ring, standard error.
        peak: (2,), wave vector at which S, averaged over every other frame, is highest, 1/length.
        positional: S/N at `peak` in the other frames, which is unbiased by the choice of peak; 1 in a lattice at rest.
    """

    kx: Annotated[np.ndarray, OMITTED]
    ky: Annotated[np.ndarray, OMITTED]
    on_lattice: Annotated[np.ndarray, OMITTED]
    k: np.ndarray
    value: np.ndarray
    error: np.ndarray
    peak: np.ndarray
    positional: Annotated[Estimate, Key("positional_order_squared")]


@dataclass(frozen=True)
class Order(Result):
    """Order of the discs of one log (no unit, except for times and lengths).

    Attributes:
        window, frames: window of time that was used, and number of instants in it.
        local, whole: mean |ψ₆| of a disc, and |Ψ₆|, the modulus of the mean of ψ₆ over all discs.
        square, hexagons: N ⟨|Ψ₆|²⟩, and fraction of the discs that have six neighbours.
        time, series: (F,), instants from the start of the log on, and |Ψ₆| at these instants.
        distance, correlation, correlation_error: (B,), middle of each bin of distances r, length; g₆(r) = ⟨Re ψ₆*(0)
            ψ₆(r)⟩ for two discs at distance r, and its standard error.
        structure: structure factor; None unless the box is periodic.
        compressibility: theoretical limit of S(k) at small k; None if theory is not available.
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

    def plain_tables(self) -> list[Table]:
        """Return the tables of hexagonal order, its correlation, and the structure factor of a periodic box."""
        rows = [
            ("|ψ₆| of a disc, mean", self.local),
            ("|Ψ₆|, of all discs together", self.whole),
            ("N |Ψ₆|²", self.square),
            ("fraction of discs with six neighbours", self.hexagons),
        ]
        notes = [f"{self.window}, {self.frames} frames"]
        correlation = self.distance, self.correlation, self.correlation_error
        functions = [_function("Correlation g₆ of ψ₆ (no unit)", "r (length)", *correlation)]
        if (structure := self.structure) is None:
            notes.append("S(k) and positional order are measured in periodic boxes only")
        else:
            rows.append(("S/N at the highest peak (positional order, squared)", structure.positional))
            notes.append(f"highest peak of S at k = ({structure.peak[0]:.5g}, {structure.peak[1]:.5g})")
            title = "Structure factor, averaged over directions (no unit)"
            functions.append(_function(title, "k (1/length)", structure.k, structure.value, structure.error))
        if self.compressibility is not None:
            notes.append(f"theory for S(k) at small k: {self.compressibility:.4g} (nT times the compressibility)")
        return [estimates("Order (no unit)", rows, notes), *functions]

    def summary(self) -> str:
        """Return the headline: |Ψ₆|, from 0 to 1, and the fraction of discs with six neighbours; there is no theory."""
        return (
            f"|Ψ₆| of all discs is {format_estimate(self.whole)} (0 without order, 1 in a perfect crystal), and "
            f"{100 * self.hexagons.value:.0f} % have six neighbours; theory is not available for either."
        )

    def figure(self) -> "Figure":
        """Draw |Ψ₆| against time and g₆ against distance; in a periodic box also S against wave number and vector."""
        from idealgas.presentation.style import COLOURS, GREY, panels

        figure, axes = panels(1 if self.structure is None else 2, 2)
        series, correlation = axes[:2]
        series.plot(self.time, self.series, color=COLOURS[0], label="measured")
        series.axvspan(self.window.start, self.window.end, color=GREY, alpha=0.12, label="averaged window")
        series.time_axis()
        series.set(ylim=(0, 1), ylabel="|Ψ₆| of all discs (no unit)")
        x, y, error = self.distance, self.correlation, self.correlation_error
        correlation.errorbar(x, y, error, fmt=".", ms=3, color=COLOURS[0], label="measured")
        correlation.axhline(self.whole.value**2, color=GREY, linewidth=0.9, label="|Ψ₆|² (no correlation left)")
        correlation.set(
            xlabel="r (length)", ylabel="g₆(r) (no unit)", ylim=(None, None if self.whole.value < 0.5 else 1)
        )
        if self.structure is not None:
            rings, vectors = axes[2:]
            k, value, error = self.structure.k, self.structure.value, self.structure.error
            rings.errorbar(k, value, error, fmt=".", ms=4, color=COLOURS[0], label="mean over directions")
            if (limit := self.compressibility) is not None:
                rings.axhline(
                    limit, color=GREY, linestyle="--", linewidth=0.9, label="theory for small k: compressibility"
                )
            rings.set(yscale="log", xlabel="k (1/length)", ylabel="S(k) (no unit)", xlim=(0, None))
            _draw_vectors(vectors, self.structure)
        for ax in axes[:3]:
            ax.legend()
        return figure


class OrderAnalysis(Analysis):
    """Order of the discs of one log."""

    position = 80
    reported_from = DENSE
    headline = "whole"
    results = (Order,)
    sections = (
        Section(
            "Order",
            "Hexagonal order against time and its correlation against distance; in a periodic box the structure factor",
        ),
    )
    reads = "frames"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Order:
        """Measure how well the discs of a gas are ordered between two times of its log.

        The local order ψ₆ of each disc (`bond_order`) is averaged over all discs, and its correlation between pairs of
        discs is measured. In a periodic box the structure factor S(k) is measured as well and, at small k, compared
        with the theory of a fluid of equal discs. All discs have the same weight; walls inside do not separate them.

        Raises:
            UserError: if discs have no positions, if there is a piston, or if the window has too few checkpoints.
        """
        if not log.has_positions:
            raise NotApplicableError(f"{log.path}: order requires discs with positions")
        window, times = _instants(log, start, end)
        first = int(times.searchsorted(window.start))
        number, waves = len(log.discs), WaveVectors(log.box, len(log.discs))
        bins = _Distances(log)
        rows, factors = [], []
        for k, state in enumerate(frames(log, times, progress)):
            local, neighbours = bond_order(state.position, log.box, log.periodic)
            rows.append((np.abs(local).mean(), np.abs(local.mean()), (neighbours == FOLD).mean()))
            if k >= first:
                bins.add(state.position, local)
                factors += [waves.structure_factor(state.position)] if all(log.periodic) else []
        size, whole, six = np.array(rows).T
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


def _function(title: str, of: str, *columns: np.ndarray) -> Table:
    """Return a table of a function of distance or wave number, with its standard errors."""
    rows = [
        (Number(float(x), ".4g"), *with_error(float(y), float(error))) for x, y, error in zip(*columns, strict=True)
    ]
    return Table(title, (of, "value", "± s.e."), rows, most=MOST_ROWS)


def _instants(log: Log, start: float | None, end: float | None) -> tuple[Window, np.ndarray]:
    """Return the window and the instants of the measurement, from the start of the log (or `start`) to its end."""
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
    """Return the limit 1/(d(φZ)/dφ) of S(k) at small k; None unless a periodic box holds a fluid of equal discs."""
    gas, phi = log.discs, log.discs.packing_fraction * log.scene.properties.interacting
    if not all(log.periodic) or np.ptp(gas.radius) > 0 or phi > hard_discs.HIGHEST:
        return None
    return 1 / float(hard_discs.inverse_compressibility(phi))


class _Distances:
    """Sums of Re ψ₆*(0) ψ₆(r) over pairs of discs, in bins of distance up to half the shorter side of the box."""

    def __init__(self, log: Log) -> None:
        number = len(log.discs)
        self._box, self._periodic = log.box, log.periodic
        self._reach, spacing = min(log.box) / 2, math.sqrt(log.discs.area / number)
        self._bins = max(int(BINS_A_SPACING * self._reach / spacing), 1)
        self._chosen = np.arange(0, number, -(-(number**2) // MOST_PAIRS))
        self._sums: list[np.ndarray] = []

    def add(self, position: np.ndarray, local: np.ndarray) -> None:
        """Add the pairs at one instant, given the positions (N, 2) and the local order ψ₆ (N,) of the discs."""
        squared = np.zeros((len(self._chosen), len(position)))
        for place, size, periodic in zip(position.T, self._box, self._periodic, strict=True):
            apart = place[self._chosen, None] - place
            squared += (apart - size * np.round(apart / size) if periodic else apart) ** 2
        bins = np.minimum(np.sqrt(squared) * (self._bins / self._reach), self._bins).astype(np.int64)
        bins[np.arange(len(self._chosen)), self._chosen] = self._bins  # a disc does not pair with itself
        products = sum(part[self._chosen, None] * part for part in (local.real, local.imag))
        sums = (np.bincount(bins.ravel(), weights, self._bins + 1) for weights in (products.ravel(), None))
        self._sums.append(np.array([each[: self._bins] for each in sums]))

    def correlation(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the middles of bins that usually contain pairs, the mean product in each, and its standard error."""
        product, pairs = np.moveaxis(np.array(self._sums), 1, 0)
        middle = (np.arange(self._bins) + 0.5) * (self._reach / self._bins)
        filled = (pairs > 0).mean(axis=0) > 0.5  # the error of a rarely observed product is unknown
        value = product.sum(axis=0)[filled] / pairs.sum(axis=0)[filled]
        influence = (product[:, filled] - value * pairs[:, filled]) / pairs[:, filled].mean(axis=0)
        error = np.array([mean(column).standard_error for column in influence.T])
        return middle[filled], value, error


class WaveVectors:
    """Wave vectors 2π(a/Lx, b/Ly) of a periodic box, up to a maximum and one from each pair ±k."""

    def __init__(self, box: tuple[float, float], number: int) -> None:
        """Choose the wave vectors for a box (width and height, length) with a given number of discs."""
        reach = REACH * math.sqrt(number / (box[0] * box[1]))
        most = [max(int(reach * size / (2 * math.pi)), 1) for size in box]
        self.kx = 2 * math.pi / box[0] * np.arange(most[0] + 1)
        self.ky = 2 * math.pi / box[1] * np.arange(-most[1], most[1] + 1)
        size = np.hypot(self.kx[:, None], self.ky)
        twice = (self.kx[:, None] == 0) & (self.ky <= 0)  # the second of a pair, or k = 0
        self.used = ~twice & (size <= max(reach, size[0, most[1] + 1], size[1, most[1]]))
        self.size = size[self.used]

    def structure_factor(self, position: np.ndarray) -> np.ndarray:
        """Return S (K,) at the wave vectors that are used, for positions (N, 2)."""
        waves = zip((self.kx, self.ky[len(self.ky) // 2 :]), position.T, strict=True)
        along, up = (np.vander(np.exp(1j * k[1] * x), len(k), increasing=True) for k, x in waves)  # exp(ikx)
        across = np.hstack((up[:, :0:-1].conj(), up))
        return np.asarray(np.abs((along.T @ across)[self.used]) ** 2 / len(position))

    def structure(self, frames: np.ndarray, number: int) -> Structure:
        """Return the structure factor of a gas of `number` discs, given S (F, K) in F ≥ 2 frames."""
        edges = np.linspace(0.0, self.size.max() * (1 + 1e-9), RINGS + 1)
        ring = np.digitize(self.size, edges) - 1
        filled = np.unique(ring)
        means = [mean(frames[:, ring == r].mean(axis=1)) for r in filled]
        on_lattice = np.full(self.used.shape, np.nan)
        on_lattice[self.used] = frames.mean(axis=0)
        best = int(frames[::2].mean(axis=0).argmax())
        column, row = (index[best] for index in np.nonzero(self.used))
        return Structure(
            self.kx,
            self.ky,
            on_lattice,
            k=np.array([self.size[ring == r].mean() for r in filled]),
            value=np.array([estimate.value for estimate in means]),
            error=np.array([estimate.standard_error for estimate in means]),
            peak=np.array((self.kx[column], self.ky[row])),
            positional=mean(frames[1::2, best] / number),
        )


def _draw_vectors(ax: "Axes", structure: Structure) -> None:
    """Draw a map of S over all wave vectors, including those at -k."""
    from matplotlib.colors import LogNorm

    half = structure.on_lattice
    both = np.concatenate((half[:0:-1, ::-1], half))
    both[len(half) - 1] = np.fmax(half[0], half[0, ::-1])
    kx = np.concatenate((-structure.kx[:0:-1], structure.kx))
    low, high = np.nanmin(half), np.nanmax(half)
    norm = LogNorm(max(low, high * 1e-4), high)
    shown = ax.pcolormesh(kx, structure.ky, both.T, norm=norm, cmap="cividis", rasterized=True)
    ax.set(aspect="equal", xlabel="kx (1/length)", ylabel="ky (1/length)")
    ax.grid(visible=False)
    ax.figure.colorbar(shown, ax=ax, label="S(k) (no unit)")
