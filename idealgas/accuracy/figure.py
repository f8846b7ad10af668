"""Figures of accuracy: errors against CPU time, all errors in detail, and the lifetime of a periodic orbit."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from idealgas.accuracy.orbit import OrbitStudy
from idealgas.accuracy.report import flat_row, nearest
from idealgas.accuracy.study import Accuracy
from idealgas.presentation.style import COLOURS, GREY, Panel, add_title, panels

AVERAGES = {
    "pressure, pairs (relative)": "z_pairs_bias",
    "collision rate (relative)": "rate_bias",
    "pressure, walls (relative)": "z_walls_bias",
    "missed collisions (fraction)": "missed_share",
    "deepest overlap (σ)": "deepest_overlap",
    "Kolmogorov-Smirnov distance": "ks_distance",
}
"""Label and column of the error of each average, the most important first."""

MARKERS = "osD^vP*X"
PATHS = (0.5, 1.0, 2.0)  # collisions per disc for which trajectory errors are shown against CPU time
LEAST = 1e-17  # smallest error that is drawn, diameters
ROUNDING = 1e-9  # magnitude below which the error of an average is due to rounding
SHOWN_STEPS = 4  # number of evenly spaced points that are labelled with their time step


def accuracy_figure(study: Accuracy) -> Figure:
    """Return a figure with the error of an average against CPU time, and the trajectory errors in each precision."""
    figure, axes = panels(1 + bool(len(study.collisions)))
    _cost(axes[0], study)
    if len(axes) > 1:
        _digits(axes[1], study)
    return add_title(figure, f"{study.title}: CPU time and accuracy")


def _points(rows: list[dict[str, Any]], name: str, least: float = 0.0) -> np.ndarray:
    """Return (n, 4) time step, CPU time, magnitude and standard error of an error, for magnitudes above `least`."""
    points = [
        (row["dt"] or 0.0, row["cpu_s_per_time"], abs(row[name]), row.get(f"{name}_error") or 0.0)
        for row in rows
        if row[name] is not None
    ]
    return np.array([point for point in points if max(point[2:]) > least]).reshape(-1, 4)


def _cost(ax: Panel, study: Accuracy) -> None:
    """Draw the error of the first measured average against CPU time: a curve for the time steps, and a point.

    The point is the event-driven run. An error smaller than its standard error cannot be resolved and is drawn at the
    standard error.
    """
    exact = flat_row(study.event_driven, study)
    rows = [flat_row(row, study) for row in study.steps]
    label, name = next(entry for entry in AVERAGES.items() if len(_points(rows, entry[1], ROUNDING)))
    steps, cost, error, spread = _points(rows, name, ROUNDING).T
    cost /= exact["cpu_s_per_time"]
    error = np.maximum(error, spread)
    ax.errorbar(cost, error, np.minimum(spread, 0.9 * error), fmt="o-", ms=5, color=COLOURS[1])
    for k in np.unique(np.linspace(0, len(steps) - 1, SHOWN_STEPS).round().astype(int)):
        text = f"{'time step ' if k == 0 else ''}{steps[k]:.2g}"
        ax.annotate(text, (cost[k], error[k]), (7, 5), textcoords="offset points", color=COLOURS[1])
    best = _points([exact], name, ROUNDING)[:, 2:].max(initial=0.0) or 0.5 * float(error.min())
    ax.plot(1, best, "*", ms=18, color=COLOURS[0])
    ax.annotate("event-driven", (1, best), (12, -4), textcoords="offset points", color=COLOURS[0], weight="bold")
    ax.set(xscale="log", yscale="log", xlim=(0.75, 2 * cost.max()), ylim=(0.5 * min(*error, best), 2 * error.max()))
    ax.xaxis.set_major_formatter("{x:g}")
    ax.yaxis.set_major_formatter(PercentFormatter(1))
    ax.set(xlabel="CPU time relative to the event-driven run (no unit)", ylabel=f"error of the {label}")


def _digits(ax: Panel, study: Accuracy) -> None:
    """Draw the distance from the true paths against collisions, for two precisions and the shortest time step."""
    finest = study.steps[-1]
    rows = {
        "7 digits": (study.precisions[0], COLOURS[2]),
        "16 digits: event-driven": (study.event_driven, COLOURS[0]),
        f"time step {finest.case.dt:.2g}": (finest, COLOURS[1]),
    }
    for name, (row, colour) in rows.items():
        assert row.trajectory is not None
        ax.plot(study.collisions, np.maximum(row.trajectory, LEAST), "o-", ms=4, color=colour, label=name)
    ax.set(yscale="log", ylim=(LEAST, 100))
    ax.set(xlabel="collisions per disc (no unit)", ylabel="rms distance from the true paths (diameters)")
    ax.legend()


def details_figure(study: Accuracy) -> Figure:
    """Return a figure with all errors of averages and of the motion against CPU time, and with all trajectories."""
    motion = bool(len(study.collisions))
    figure, axes = panels(3 if motion else 1)
    _errors_against_time(axes[0], study, AVERAGES, ROUNDING)
    axes[0].set_ylabel("error of averages (no unit)")
    if motion:
        picks = [nearest(study.collisions, count) for count in PATHS]
        paths = {f"path at {study.collisions[k]:.2g} collisions per disc": f"trajectory {k}" for k in picks}
        _errors_against_time(
            axes[1], study, paths | {"reversal (σ)": "way_back_error", "energy drift (relative)": "energy_drift"}
        )
        axes[1].set_ylabel("error of the motion (diameters)")
        _trajectories(axes[2], study)
    figure.set_figheight(4.6 * len(axes))
    return add_title(figure, f"{study.title}: every error")


def _errors_against_time(ax: Panel, study: Accuracy, errors: dict[str, str], least: float = 0.0) -> None:
    """Draw a curve over the time steps for each error; the event-driven run and the precisions are points."""
    missing = np.full(len(study.collisions), None)
    rows: list[dict[str, Any]] = []
    for case in study.rows:
        path = missing if case.trajectory is None else case.trajectory
        rows.append(flat_row(case, study) | {f"trajectory {k}": error for k, error in enumerate(path)})
    steps = [row for row in rows if row["dt"] is not None]
    precisions = [row for row in rows if row["precision"] is not None]
    for (label, name), colour, marker in zip(errors.items(), COLOURS, MARKERS, strict=False):
        _, time, value, spread = _points(steps, name, least).T
        if len(time):
            ax.errorbar(time, value, np.minimum(spread, 0.9 * value), fmt=f"-{marker}", ms=4, color=colour, label=label)
        for marked, fill in ((rows[:1], colour), (precisions, "none")):
            _, time, value, _ = _points(marked, name, least).T
            ax.plot(time, value, marker, ms=9, mfc=fill, mec=colour)
    ax.axvline(rows[0]["cpu_s_per_time"], color=GREY, linestyle="--", linewidth=0.8, label="event-driven (filled)")
    for k, row in enumerate(precisions):
        time = row["cpu_s_per_time"]
        ax.axvline(time, color=GREY, linestyle=":", linewidth=0.8)
        ax.annotate(
            row["precision"], (time, 1.0), xycoords=("data", "axes fraction"), rotation=90, fontsize="small",
            color=GREY, ha="left" if k % 2 else "right", va="top",
        )  # fmt: skip
    ax.set(xscale="log", yscale="log", xlabel="CPU seconds per unit of simulated time")
    ax.legend()


def _trajectories(ax: Panel, study: Accuracy) -> None:
    """Draw the rms distance from the double-double motion against collisions per disc."""
    rows = [row for row in study.rows if row.case.precision != "float64"]
    for k, row in enumerate(rows):
        if row.trajectory is None:
            continue
        steps = row.case.dt is not None
        colour = COLOURS[1] if steps else COLOURS[0] if row.case.precision is None else COLOURS[2]
        shade = 0.3 + 0.7 * k / len(rows) if steps else 1.0
        path = np.maximum(row.trajectory, LEAST)
        ax.plot(study.collisions, path, "-o", ms=3, color=colour, alpha=shade, label=row.case.name)
    ax.set_yscale("log")
    ax.set(xlabel="collisions per disc (no unit)", ylabel="rms distance from the double-double motion (diameters)")
    ax.legend()


def orbit_figure(study: OrbitStudy) -> Figure:
    """Return a figure of the orbit lifetime against digits: all boxes, the medians, and a line through the medians."""
    figure, (ax,) = panels(1)
    for k, survival in enumerate(study.survivals):
        x = survival.digits + np.linspace(-0.5, 0.5, len(survival.times))
        label = "one box and radius" if k == 0 else None
        ax.plot(x, survival.times, ".", color=COLOURS[5], label=label)
        ax.annotate(survival.precision, (survival.digits, survival.median), (8, -14), textcoords="offset points")
    digits, median = np.array([(s.digits, s.median) for s in study.survivals]).T
    ax.plot(digits, median, "D", color=COLOURS[0], label=f"median of {study.placements}")
    x = np.array([0.0, 1.05 * digits.max()])
    line = median.mean() + study.time_per_digit * (x - digits.mean())
    ax.plot(x, line, "--", color=COLOURS[1], label=f"{study.time_per_digit:.3g} time units per digit")
    ax.set_xlim(0, 1.2 * digits.max())
    ax.set_ylim(bottom=0)
    ax.set(xlabel="decimal digits carried (no unit)", ylabel="lifetime of the orbit (time, at speed 1)")
    ax.legend()
    return add_title(figure, "Unstable periodic orbit: lifetime against digits")
