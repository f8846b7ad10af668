"""Draw a quantity from a sweep against one of the axes of the sweep."""

import os
from collections.abc import Iterable
from fnmatch import fnmatchcase
from statistics import fmean
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from idealgas.analysis import registry
from idealgas.errors import UserError, unknown
from idealgas.presentation.quantities import identifier
from idealgas.presentation.style import add_title, curve_style, panels
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
"""Units of scene keys, by the last component of their names."""

QUANTITY_UNITS = {
    "*.area": "length²",
    "*.end_time": "time",
    "*.free_energy": "energy",
    "*.free_paths.*.path": "length",
    "*.free_paths.*.speed": "length/time",
    "*.free_paths.*.time": "time",
    "*.mean_temperature": "energy",
    "*.pressure": "energy/length²",
    "*.rate": "1/time",
    "*.relaxation_time": "time",
    "*.temperature": "energy",
    "*.window.end": "time",
    "*.window.start": "time",
    "evolution.rest": "length",
    "temperature.species.*.[xy]": "energy",
    "temperature.species.*.both": "energy",
    "transport.diffusion.*.coefficient": "length²/time",
}
"""Units of quantities in results.csv, by patterns of their names; all other quantities that are drawn have no unit."""


def sweep_figure(folder: str | os.PathLike[str], quantity: str | None = None, axis: str | None = None) -> Figure:
    """Return a figure of a quantity against an axis, with one curve for each combination of values of the other axes.

    Measured and theoretical values are averages over the replicates. Theory is evaluated only at the points of the
    sweep, where it has markers; the straight lines between them are a guide to the eye.

    Args:
        folder: folder of the sweep.
        quantity: name of the quantity in results.csv; None for the main quantity of the first analysis that has one, or
            otherwise for the first quantity with a standard error.
        axis: key of an axis with numbers; None for the first such axis.

    Raises:
        UserError: if the sweep has no such quantity or axis, or no results.
    """
    rows = result_rows(folder)
    axis = _choice("axis", axis, [key for key in _axes(rows) if _all_numbers(row[key] for row in rows)])
    headlines = [f"{analysis.name}.{analysis.headline}" for analysis in registry.analyses()]
    quantities = [row["quantity"] for row in rows]
    estimates = [row["quantity"] for row in rows if row.get("standard_error") is not None]
    first = [name for name in quantities if any(fnmatchcase(name, headline) for headline in headlines)]
    quantity = _choice("quantity", quantity, list(dict.fromkeys([*first, *estimates, *quantities])))
    curves: dict[str, dict[float, list[Row]]] = {}
    for row in rows:
        if row["quantity"] == quantity:
            label = ", ".join(f"{key} = {_value(row[key])}" for key in _axes(rows) if key != axis)
            curves.setdefault(label, {}).setdefault(float(row[axis]), []).append(row)
            group = row["group"]
    figure, (ax,) = panels(1)
    for k, (label, points) in enumerate(curves.items()):
        places = sorted(points)
        values, errors = zip(*(average(points[place]) for place in places), strict=True)
        colour, _, marker = curve_style(k)
        ax.errorbar(places, values, yerr=errors, fmt=marker, color=colour, capsize=3, label=label or "measured")
        known = [(place, *theory) for place in places if (theory := _theory(points[place]))]
        if known:  # one legend entry is enough, because each theory line passes through the points of its curve
            x, theories, theory_errors = np.array(known).T
            ax.theory(x, theories, theory_errors, label="theory, at the points", marker="x")
    ax.set(xlabel=_axis_name(axis), ylabel=_quantity_name(quantity, group))
    ax.legend()
    return say_missing(figure, folder)


def say_missing(figure: Figure, folder: str | os.PathLike[str]) -> Figure:
    """Write above the figure of a sweep how many of its runs have no results yet, and return the figure.

    If no results are missing, nothing is written.
    """
    missing, total = missing_runs(folder)
    return add_title(figure, f"{missing:,} of {total:,} runs are missing") if missing else figure


def _theory(rows: list[Row]) -> tuple[float, float] | None:
    """Return the averages over replicates of the theoretical value and its error, which all replicates share.

    The result is None if theory is not available.
    """
    known = [row for row in rows if row.get("theory") is not None]
    if not known:
        return None
    return fmean(row["theory"] for row in known), fmean(row["theory_error"] for row in known)


def _value(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _axis_name(key: str) -> str:
    """Return the name of an axis in words, with any unit, such as "temperature of 'gas' (energy)"."""
    if key == PHI:
        return "packing fraction φ"
    *owner, name = key.split(".")
    if owner[:1] == ["species"] and len(owner) > 1:
        words = f"{_words(name)} of '{'.'.join(owner[1:])}'"
    else:
        words = _words(key.replace(".", " "))
    return words + _unit(UNITS.get(name))


def _quantity_name(quantity: str, group: str) -> str:
    """Return the name of a quantity in words, with its unit, such as "temperature: species: 'gas': both (energy)"."""
    unit = next((unit for pattern, unit in QUANTITY_UNITS.items() if fnmatchcase(quantity, pattern)), None)
    groups = {identifier(word): f"'{word}'" for word in (*group.split(", "), group)}
    return ": ".join(groups.get(part) or _words(part) for part in quantity.split(".")) + _unit(unit)


def _unit(unit: str | None) -> str:
    return f" ({unit})" if unit else ""


def _words(name: str) -> str:
    return name.replace("_", " ")


def _axes(rows: list[Row]) -> list[str]:
    return [name for name in rows[0] if name not in ("point", "replicate", "seed", *RESULT)]


def _all_numbers(values: Iterable[Any]) -> bool:
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)


def _choice(kind: str, requested: str | None, allowed: list[str]) -> str:
    if not allowed:
        raise UserError(f"no {kind} with numbers to draw")
    if requested is not None and requested not in allowed:
        raise unknown(kind, requested, allowed)
    return requested or allowed[0]
