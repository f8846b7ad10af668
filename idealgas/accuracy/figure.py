"""Pictures of the accuracy: what it costs, every error in detail, and the lifetime of an orbit."""

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from idealgas.accuracy.orbit import OrbitStudy
from idealgas.accuracy.study import Accuracy, Row
from idealgas.analysis.core.style import COLOURS, GREY, Panel, add_title, panels

Measure = Callable[[Row], tuple[float, float] | None]
"""Function that gives an error of a row with its standard error; None if the row has no such error."""


def _estimate(name: str) -> Measure:
    def measure(row: Row) -> tuple[float, float] | None:
        found = getattr(row, name)
        return None if found is None else (abs(found.value), found.standard_error)

    return measure


def _missed(row: Row) -> tuple[float, float] | None:
    return (row.missed.share, row.missed.error) if row.missed and row.missed.missed else None


def _overlap(row: Row) -> tuple[float, float] | None:
    return (row.averages.overlap, 0.0) if row.averages and row.averages.overlap > 1e-9 else None


def _drift(row: Row) -> tuple[float, float] | None:
    return (abs(row.averages.drift), 0.0) if row.averages and row.averages.drift else None


def _distance(row: Row) -> tuple[float, float] | None:
    return (row.averages.distance, 0.0) if row.averages and row.averages.distance else None


def _way_back(row: Row) -> tuple[float, float] | None:
    return (row.way_back, 0.0) if row.way_back else None


def _trajectory(index: int) -> Measure:
    return lambda row: (float(row.trajectory[index]), 0.0) if row.trajectory is not None else None


AVERAGES: dict[str, Measure] = {
    "pressure, pairs (relative)": _estimate("z_pairs"),
    "collision rate (relative)": _estimate("rate"),
    "pressure, walls (relative)": _estimate("z_walls"),
    "missed collisions (share)": _missed,
    "deepest overlap (σ)": _overlap,
    "Kolmogorov-Smirnov distance": _distance,
}
MARKERS = "osD^vP*X"
ENTRIES = (0.5, 1.0, 2.0)  # collisions per disc at which errors of trajectories are shown against CPU time
LEAST = 1e-17  # error in diameters below which nothing is drawn
SHOWN_STEPS = 4
"""Number of time steps, evenly chosen, whose length is written at their points."""


def accuracy_figure(found: Accuracy) -> Figure:
    """Picture of what accuracy costs: the error of an average against CPU time, and what digits do to trajectories."""
    motion = bool(len(found.collisions))
    figure, axes = panels(1 + motion)
    _cost(axes[0], found)
    if motion:
        _digits(axes[1], found)
    return add_title(figure, f"{found.title}: what accuracy costs")


def _cost(ax: Panel, found: Accuracy) -> None:
    """Draw the error of the first average that was measured against CPU time: one curve of time steps, and one point.

    The statistical error is the least that an error is drawn as, as a smaller one cannot be seen.
    """
    own = found.event_driven.timing.median
    names = [name for name, measure in AVERAGES.items() if any(measure(row) for row in found.steps)]
    measure = AVERAGES[names[0]]
    shown = [(row.timing.median / own, *error, row.case.dt) for row in found.steps if (error := measure(row))]
    cost, error, spread, steps = np.array(shown, float).T
    error = np.maximum(error, spread)
    ax.errorbar(cost, error, np.minimum(spread, 0.9 * error), fmt="o-", ms=5, color=COLOURS[1])
    for k in np.unique(np.linspace(0, len(steps) - 1, SHOWN_STEPS).round().astype(int)):
        text = f"{'time step ' if k == 0 else ''}{steps[k]:.2g}"
        ax.annotate(text, (cost[k], error[k]), (7, 5), textcoords="offset points", color=COLOURS[1])
    best = max(measure(found.event_driven) or (0.5 * float(error.min()), 0.0))
    ax.plot(1, best, "*", ms=18, color=COLOURS[0])
    ax.annotate("event-driven", (1, best), (12, -4), textcoords="offset points", color=COLOURS[0], weight="bold")
    ax.set(xscale="log", yscale="log", xlim=(0.75, 2 * cost.max()), ylim=(0.5 * min(*error, best), 2 * error.max()))
    ax.xaxis.set_major_formatter("{x:g}")
    ax.yaxis.set_major_formatter(PercentFormatter(1))
    ax.set_xlabel("CPU time, that of the event-driven run is 1 (no unit)")
    ax.set_ylabel(f"error of the {names[0]}")


def _digits(ax: Panel, found: Accuracy) -> None:
    """Draw the distance from the true paths against collisions: of both precisions, and of the shortest time step."""
    finest = found.steps[-1]
    rows = {
        "7 digits": (found.precisions[0], COLOURS[2]),
        "16 digits: event-driven": (found.event_driven, COLOURS[0]),
        f"time step {finest.case.dt:.2g}": (finest, COLOURS[1]),
    }
    for name, (row, colour) in rows.items():
        assert row.trajectory is not None
        ax.plot(found.collisions, np.maximum(row.trajectory, LEAST), "o-", ms=4, color=colour, label=name)
    ax.set(yscale="log", ylim=(LEAST, 100))
    ax.set_xlabel("collisions per disc (no unit)")
    ax.set_ylabel("rms distance from the true paths (diameters)")
    ax.legend()


def details_figure(found: Accuracy) -> Figure:
    """Picture of all errors of averages and of the motion against CPU time, and of all trajectories."""
    motion = bool(len(found.collisions))
    figure, axes = panels(3 if motion else 1)
    _errors_against_time(axes[0], found, AVERAGES)
    axes[0].set_ylabel("error of averages (no unit)")
    if motion:
        picks = [int(np.abs(found.collisions - entry).argmin()) for entry in ENTRIES]
        measures = {f"path at {found.collisions[k]:.2g} collisions per disc": _trajectory(k) for k in picks}
        _errors_against_time(axes[1], found, measures | {"way back (σ)": _way_back, "energy drift (relative)": _drift})
        axes[1].set_ylabel("error of the motion (diameters)")
        _trajectories(axes[2], found)
    figure.set_figheight(4.6 * len(axes))
    return add_title(figure, f"{found.title}: every error")


def _errors_against_time(ax: Panel, found: Accuracy, measures: dict[str, Measure]) -> None:
    """Draw one curve over the time steps for each error; the event-driven run and the precisions are points."""
    for (name, measure), colour, marker in zip(measures.items(), COLOURS, MARKERS, strict=False):
        points = [(row.timing.median, *error) for row in found.steps if (error := measure(row))]
        if points:
            time, value, spread = np.array(points).T
            ax.errorbar(time, value, np.minimum(spread, 0.9 * value), fmt=f"-{marker}", ms=4, color=colour, label=name)
        for row in (found.event_driven, *found.precisions):
            if error := measure(row):
                filled = colour if row is found.event_driven else "none"
                ax.plot(row.timing.median, error[0], marker, ms=9, mfc=filled, mec=colour)
    own = found.event_driven.timing.median
    ax.axvline(own, color=GREY, linestyle="--", linewidth=0.8, label="event-driven (filled)")
    for k, row in enumerate(found.precisions):
        ax.axvline(row.timing.median, color=GREY, linestyle=":", linewidth=0.8)
        ax.annotate(
            row.case.precision or "", (row.timing.median, 1.0), xycoords=("data", "axes fraction"), rotation=90,
            fontsize="small", color=GREY, ha="left" if k % 2 else "right", va="top",
        )  # fmt: skip
    ax.set(xscale="log", yscale="log")
    ax.set_xlabel("CPU seconds per unit of simulated time")
    ax.legend()


def _trajectories(ax: Panel, found: Accuracy) -> None:
    """Draw the rms distance from the double-double motion against collisions per disc."""
    rows = [row for row in found.rows if row.case.precision != "float64"]
    for k, row in enumerate(rows):
        if row.trajectory is None:
            continue
        steps = row.case.dt is not None
        colour = COLOURS[1] if steps else COLOURS[0] if row.case.precision is None else COLOURS[2]
        shade = 0.3 + 0.7 * k / len(rows) if steps else 1.0
        path = np.maximum(row.trajectory, LEAST)
        ax.plot(found.collisions, path, "-o", ms=3, color=colour, alpha=shade, label=row.case.name)
    ax.set_yscale("log")
    ax.set_xlabel("collisions per disc (no unit)")
    ax.set_ylabel("rms distance from the truth (diameters)")
    ax.legend()


def orbit_figure(found: OrbitStudy) -> Figure:
    """Picture of the lifetime of the orbit against digits: every box, the medians, and a line through them."""
    figure, (ax,) = panels(1)
    for k, survival in enumerate(found.survivals):
        x = survival.digits + np.linspace(-0.5, 0.5, len(survival.times))
        label = "one box and radius" if k == 0 else None
        ax.plot(x, survival.times, ".", color=COLOURS[5], label=label)
        ax.annotate(survival.precision, (survival.digits, survival.median), (8, -14), textcoords="offset points")
    digits, median = np.array([(s.digits, s.median) for s in found.survivals]).T
    ax.plot(digits, median, "D", color=COLOURS[0], label=f"median of {found.placements}")
    x = np.array([0.0, 1.05 * digits.max()])
    line = median.mean() + found.time_per_digit * (x - digits.mean())
    ax.plot(x, line, "--", color=COLOURS[1], label=f"{found.time_per_digit:.3g} time units a digit")
    ax.set_xlim(0, 1.2 * digits.max())
    ax.set_ylim(bottom=0)
    ax.set_xlabel("decimal digits carried (no unit)")
    ax.set_ylabel("orbit lasts (time, at speed 1)")
    ax.legend()
    return add_title(figure, "Unstable periodic orbit: how long digits keep it")
