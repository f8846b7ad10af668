"""Figure of one quantity of a sweep against one of its axes."""

import os
from collections.abc import Iterable
from fnmatch import fnmatchcase
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.interpolate import PchipInterpolator

from idealgas.analysis import registry
from idealgas.analysis.core.style import LINES, add_title, curve_style, panels
from idealgas.errors import UserError, unknown
from idealgas.sweep.results import RESULT, average, missing_runs, result_rows
from idealgas.sweep.tables import PHI

Row = dict[str, Any]

UNITS = {
    "acceleration": "length/time²",
    "amplitude": "length",
    "angular_velocity": "1/time",
    "distance": "length",
    "gravity": "length/time²",
    "mass": "mass",
    "period": "time",
    "position": "length",
    "radius": "length",
    "rate": "1/time",
    "size": "length",
    "speed": "length/time",
    "temperature": "energy",
    "until": "time",
    "velocity": "length/time",
    "width": "length",
}
"""Units of keys of a scene, by the last part of their names."""


def sweep_figure(folder: str | os.PathLike[str], quantity: str | None = None, axis: str | None = None) -> Figure:
    """Figure of a quantity against an axis: averages over the replicates, theory, one curve per set of other values.

    quantity: its name in results.csv; None for the headline of the first analysis that has one, or else the first
    number with an error bar. axis: key of an axis with numbers; None for the first one.

    Raises:
        UserError: if the sweep has no such quantity or axis, or no results.
    """
    rows = result_rows(folder)
    axis = _choice("axis", axis, [key for key in _axes(rows) if _all_numbers(row[key] for row in rows)])
    headlines = [f"{analysis.name}.{analysis.headline}" for analysis in registry.analyses()]
    found = [row["quantity"] for row in rows]
    estimates = [row["quantity"] for row in rows if row.get("standard_error") is not None]
    first = [name for name in found if any(fnmatchcase(name, headline) for headline in headlines)]
    quantity = _choice("quantity", quantity, list(dict.fromkeys([*first, *estimates, *found])))
    curves: dict[str, dict[float, list[Row]]] = {}
    for row in rows:
        if row["quantity"] == quantity:
            others = ", ".join(f"{key} = {row[key]}" for key in _axes(rows) if key != axis)
            curves.setdefault(others, {}).setdefault(float(row[axis]), []).append(row)
    figure, (ax,) = panels(1)
    for k, (label, points) in enumerate(curves.items()):
        places = sorted(points)
        values, errors = zip(*(average(points[place]) for place in places), strict=True)
        colour, _, marker = curve_style(k)
        ax.errorbar(places, values, yerr=errors, fmt=marker, color=colour, capsize=3, label=label or "measured")
        known = [
            (x, row["theory"], row["theory_error"]) for x in places if (row := points[x][0]).get("theory") is not None
        ]
        if known:
            style, name = LINES[1:][k % (len(LINES) - 1)], f"{label}: theory" if label else "theory"
            ax.theory(*_smooth(*np.array(known).T), label=name, linestyle=style)
    ax.set(xlabel=_axis_name(axis), ylabel=_words(quantity))
    ax.legend()
    return say_missing(figure, folder)


def say_missing(figure: Figure, folder: str | os.PathLike[str]) -> Figure:
    """Write above the picture of a sweep how many of its runs have no results yet, if any, and return the picture."""
    missing, total = missing_runs(folder)
    return add_title(figure, f"{missing:,} of {total:,} runs are missing") if missing else figure


def _smooth(places: np.ndarray, values: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places, values and errors of a theory on a smooth curve through its points, without new maxima between them."""
    if len(places) < 3:
        return places, values, errors
    fine = np.union1d(np.linspace(places[0], places[-1], 200), places)
    return fine, PchipInterpolator(places, values)(fine), PchipInterpolator(places, errors)(fine)


def _axis_name(key: str) -> str:
    """Name of an axis in words, with its unit, where it has one."""
    if key == PHI:
        return "packing fraction φ"
    owner, _, name = key.rpartition(".")
    unit = f" ({UNITS[name]})" if name in UNITS else ""
    return f"{_words(name)}{f' of {_words(owner)}' if owner else ''}{unit}"


def _words(name: str) -> str:
    return ": ".join(name.split(".")).replace("_", " ")


def _axes(rows: list[Row]) -> list[str]:
    return [name for name in rows[0] if name not in ("point", "replicate", "seed", *RESULT)]


def _all_numbers(values: Iterable[Any]) -> bool:
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)


def _choice(what: str, asked: str | None, allowed: list[str]) -> str:
    if not allowed:
        raise UserError(f"no {what} with numbers to draw")
    if asked is not None and asked not in allowed:
        raise unknown(what, asked, allowed)
    return asked or allowed[0]
