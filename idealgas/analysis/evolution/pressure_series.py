"""Mechanical pressure on walls in time bins, the area of the gas, and its isotherm and adiabat."""

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
"""Number of time blocks; a bin consists of several blocks, from whose scatter its error bar is estimated."""

POINTS = 256
"""Number of points in the track of a piston."""

MOST_BINS = 64
STATES = 16
"""Largest number of states that are drawn in the plot of pressure against area."""

HITS = 32
"""Smallest mean number of wall hits per bin, if there is more than one bin."""

GROUP = 16
"""Number of successive bins in a group, whose scatter about a straight line is compared with the error bars."""

FAR = 0.999
"""Fraction of the groups that would be retained if all groups had the same distribution; others are outliers."""

ALL_SIDES = "all sides"

WIDER = 1.2
"""Range of areas over which the isotherm and the adiabat are drawn, relative to the range of areas of the gas."""


@dataclass(frozen=True)
class PressureSeries:
    """Mechanical pressure on walls in B time bins.

    Attributes:
        edges: (B + 1,), edges of the bins, time.
        area: (B,), mean area of the gas, length².
        pressure: (B,), momentum transferred to the wall per time and length, energy/length², by name of the wall.
        error: (B,), standard error of the pressure, energy/length², by name of the wall; nan for bins without hits.
        shown: walls in the table and figure: all sides together if the gas is uniform, otherwise pistons or each side.
        lines: isotherm and adiabat through the initial state; None without theory, or unless there is a single piston
            with gas on one side only.
        track: (POINTS,), times and, by name, mean coordinates of pistons in time blocks; None without pistons.
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
        """Centres of the bins, (B,), time."""
        return (self.edges[1:] + self.edges[:-1]) / 2


def pressure_series(log: Log, first: float, last: float) -> PressureSeries | None:
    """Return the mechanical pressure on walls between two times of a log; None without events or wall hits."""
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
    """Return the pressure in each bin and its standard error, both (bins,).

    Args:
        push: (BLOCKS,), momentum transferred to a wall in each time block.
        exposed: (BLOCKS,), exposed length of the wall, integrated over each time block.
        bins: number of bins.
    """
    values, errors = np.zeros(bins), np.full(bins, np.nan)
    for k, (given, there) in enumerate(zip(push.reshape(bins, -1), exposed.reshape(bins, -1), strict=True)):
        if given.any():
            pressure = ratio(given[there > 0], there[there > 0])
            values[k], errors[k] = pressure.value, pressure.standard_error
    return values, errors * _scatter(values, errors)


def _scatter(values: np.ndarray, errors: np.ndarray) -> float:
    """Return the scatter of bins about straight lines through GROUP successive bins, relative to error bars.

    The error bars follow from the scatter of time blocks. As sound and pistons make the pressure oscillate within a
    bin, the mean over a bin varies less than the scatter of the blocks suggests. Groups whose scatter is far above the
    median are excluded, as a gate may open or a heat bath may start in them.
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
    """Draw the pressure against time, with the external pressure on a free piston or the adiabat of a driven piston."""
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
    """Draw the pressure against the area, with arrows in the direction of time, and the isotherm and the adiabat.

    If `rest_start` is given, the piston only fluctuates after this time, and all later bins are merged into one point.
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
