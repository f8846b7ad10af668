"""Mechanical pressure on walls in bins of time, the area of the gas, and its isotherm and adiabat."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy import special

from idealgas.analysis.evolution.theory import EvolutionLaw, StateLines, state_lines
from idealgas.columns import FIRST_SEGMENT
from idealgas.fields import OMITTED, Key
from idealgas.log import Log
from idealgas.statistics.estimates import ratio
from idealgas.tallies.chambers import piston_names
from idealgas.tallies.stream import stream
from idealgas.tallies.walls import WallGauge

if TYPE_CHECKING:
    from idealgas.presentation.style import Panel

BLOCKS = 2048
"""Number of blocks of time; a bin consists of several blocks, whose scatter gives its error bar."""

POINTS = 256
"""Number of points of the track of a piston."""

MOST_BINS = 64
STATES = 16
"""Largest number of pressures that are drawn against the area."""

HITS = 32
"""Smallest mean number of wall hits in a bin, if there is more than one bin."""

GROUP = 16
"""Number of successive bins whose scatter about a straight line is compared with their error bars."""

FAR = 0.999
"""Fraction of groups, if all are alike, that count because they are not far beyond the median."""

ALL_SIDES = "all sides"

WIDER = 1.2
"""Range of the areas at which isotherm and adiabat are drawn, in units of that of the gas."""


@dataclass(frozen=True)
class PressureSeries:
    """Mechanical pressure on walls in B bins of time.

    Attributes:
        edges: (B + 1,), times between the bins.
        area: (B,), mean area of the gas, length².
        pressure: (B,), momentum given per time and length, energy/length², by the name of the wall.
        error: (B,), its standard error, energy/length², by the name of the wall; nan for a wall that was not hit.
        shown: walls in table and figure: all sides of a uniform gas together, otherwise pistons or each side.
        lines: isotherm and adiabat through the start; None without theory, or unless a single piston has gas on one
            side.
        track: times (T,) and, by name, mean coordinates (T,) of pistons in POINTS blocks of time; None without pistons.
    """

    edges: np.ndarray
    area: np.ndarray
    pressure: dict[str, np.ndarray]
    error: Annotated[dict[str, np.ndarray], Key("standard_error")]
    shown: Annotated[tuple[str, ...], OMITTED]
    lines: StateLines | None
    track: tuple[np.ndarray, dict[str, np.ndarray]] | None

    @property
    def middles(self) -> np.ndarray:
        """Times of the middles of the bins, (B,)."""
        return (self.edges[1:] + self.edges[:-1]) / 2


def pressure_series(log: Log, first: float, last: float) -> PressureSeries | None:
    """Return the mechanical pressure on the walls of a log between two times; None without events or wall hits."""
    if not log.has_events or not log.has_positions:
        return None
    gauge, blocks = WallGauge(log), np.linspace(first, last, BLOCKS + 1)
    stream(log, blocks, gauge.tallies)
    faces = gauge.faces(blocks)
    hits = sum({face.wall: face.hits for face in faces}.values())
    if not hits:
        return None
    bins = 2 ** int(np.clip(math.log2(hits / HITS), 0, math.log2(MOST_BINS)))
    given = {face.name: (face.push, face.exposed) for face in faces}
    sides = [face for face in faces if face.wall < FIRST_SEGMENT]
    if log.scene.properties.uniform:
        given[ALL_SIDES] = np.sum([face.push for face in sides], axis=0), np.sum([f.exposed for f in sides], axis=0)
        shown = [ALL_SIDES]
    else:
        faces_of_pistons = [face for face in faces if face.wall in [piston.wall for piston in gauge.moving]]
        shown = [face.name for face in faces_of_pistons or sides or faces]
    binned = {name: _in_bins(*series, bins) for name, series in given.items()}
    lines = track = None
    if gauge.moving:
        lines = state_lines(log, gauge.area(blocks)) if gauge.bounded else None
        ends, places = blocks[:: BLOCKS // POINTS], (p.place.reshape(POINTS, -1).mean(axis=1) for p in gauge.moving)
        track = (ends[1:] + ends[:-1]) / 2, dict(zip(piston_names(log.scene), places, strict=True))
    return PressureSeries(
        blocks[:: BLOCKS // bins],
        gauge.area(blocks).reshape(bins, -1).mean(axis=1),
        {name: values for name, (values, _) in binned.items()},
        {name: errors for name, (_, errors) in binned.items()},
        tuple(shown),
        lines,
        track,
    )


def _in_bins(push: np.ndarray, exposed: np.ndarray, bins: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the pressure in each bin and its standard error, (bins,), from momentum and exposed length (BLOCKS,)."""
    values, errors = np.zeros(bins), np.full(bins, np.nan)
    for k, (given, there) in enumerate(zip(push.reshape(bins, -1), exposed.reshape(bins, -1), strict=True)):
        if given.any():
            pressure = ratio(given[there > 0], there[there > 0])
            values[k], errors[k] = pressure.value, pressure.standard_error
    return values, errors * _scatter(values, errors)


def _scatter(values: np.ndarray, errors: np.ndarray) -> float:
    """Return the scatter of bins about straight lines through GROUP of them, relative to that of independent blocks.

    Sound and pistons push a wall back and forth within a bin, so that the mean of a bin varies less than its blocks.
    Groups far beyond the median do not count: in them a gate opens, or a heat bath starts.
    """
    if len(values) < GROUP:
        return 1.0
    lines, _ = np.linalg.qr(np.vander(np.arange(GROUP), 2))
    groups = sliding_window_view(values, GROUP)
    off = ((groups - groups @ lines @ lines.T) ** 2).sum(axis=1)
    expected = (sliding_window_view(errors, GROUP) ** 2).sum(axis=1)
    known = np.isfinite(off / expected)
    if not known.any():
        return 1.0
    off, expected, free = off[known], expected[known], GROUP - 2
    calm = off / expected <= np.median(off / expected) * special.chdtri(free, 1 - FAR) / special.chdtri(free, 0.5)
    return math.sqrt(off[calm].sum() / expected[calm].sum() * GROUP / free)


def draw_pressure(ax: "Panel", series: PressureSeries, law: EvolutionLaw | None) -> None:
    """Draw pressure against time, with the external pressure on a free piston or the adiabat of a driven one."""
    from idealgas.presentation.style import BLACK, COLOURS

    for name, colour in zip(series.shown, COLOURS, strict=False):
        p, error = series.pressure[name], series.error[name]
        ax.errorbar(series.middles, p, error, fmt="o", ms=3, color=colour, elinewidth=0.8, label=f"P on {name}")
    ax.set_ylabel("pressure (energy/length²)")
    if law and law.pressure:
        ax.axhline(law.pressure, ls="--", color=BLACK, label="theory: external pressure")
    elif law and series.lines and series.lines.adiabat is not None:
        adiabat = np.interp(series.area, series.lines.area, series.lines.adiabat)
        ax.plot(series.middles, adiabat, "--", color=BLACK, label="theory: adiabat")


def draw_state(ax: "Panel", series: PressureSeries, rest_start: float | None) -> None:
    """Draw pressure against area, with arrows in the order of time, and with isotherm and adiabat.

    From the time `rest_start` on, if it is given, the piston only fluctuates: all later bins are merged into one point.
    """
    from idealgas.presentation.style import COLOURS, GREY

    moves = int(np.searchsorted(series.middles, math.inf if rest_start is None else rest_start))
    on_the_way, rest = np.arange(moves), np.arange(moves, len(series.area))
    groups = [k for k in (*np.array_split(on_the_way, STATES), rest) if len(k)]
    for name, colour in zip(series.shown, COLOURS, strict=False):
        area, pressure = (
            np.array([values[k].mean() for k in groups]) for values in (series.area, series.pressure[name])
        )
        error = [math.hypot(*series.error[name][k]) / len(k) for k in groups]
        ax.errorbar(area, pressure, error, fmt="o", ms=3, color=colour, elinewidth=0.8, label=f"P on {name}, in time")
        along: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1, "width": 0.003, "headwidth": 6}
        ax.quiver(area[:-1], pressure[:-1], np.diff(area), np.diff(pressure), color=colour, alpha=0.5, **along)
    if lines := series.lines:
        middle = series.area.mean()
        near = np.abs(lines.area - middle) <= WIDER * np.abs(series.area - middle).max()
        ax.plot(lines.area[near], lines.isotherm[near], "--", color=GREY, label="isotherm through the start")
        if lines.adiabat is not None:
            ax.plot(lines.area[near], lines.adiabat[near], "-", color=GREY, label="adiabat through the start")
    ax.set(xlabel="area of the gas (length²)", ylabel="pressure (energy/length²)")
