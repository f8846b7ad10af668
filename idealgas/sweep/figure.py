"""Figure of one quantity of a sweep against one of its axes."""

import math
import os
from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from idealgas.analysis.core.style import curve_style, panels
from idealgas.errors import UserError, unknown
from idealgas.sweep.results import RESULT, result_rows

Row = dict[str, Any]


def sweep_figure(folder: str | os.PathLike[str], quantity: str | None = None, axis: str | None = None) -> Figure:
    """Figure of a quantity against an axis: averages over the replicates, theory, one curve per set of other values.

    quantity: "analysis/quantity" with the names of results.csv; None for the first number with an error bar. axis: key
    of an axis with numbers; None for the first one.

    Raises:
        UserError: if the sweep has no such quantity or axis, or no results.
    """
    rows = result_rows(folder)
    axis = _choice("axis", axis, [key for key in _axes(rows) if _all_numbers(row[key] for row in rows)])
    estimates = [_name(row) for row in rows if row.get("standard_error") is not None]
    names = list(dict.fromkeys([*estimates, *map(_name, rows)]))
    quantity = _choice("quantity", quantity, names)
    curves: dict[str, dict[float, list[Row]]] = {}
    for row in rows:
        if _name(row) == quantity:
            others = ", ".join(f"{key} = {row[key]}" for key in _axes(rows) if key != axis)
            curves.setdefault(others, {}).setdefault(float(row[axis]), []).append(row)
    figure, (ax,) = panels(1)
    for k, (label, points) in enumerate(curves.items()):
        places = sorted(points)
        values, errors = zip(*(_average(points[place]) for place in places), strict=True)
        colour, line, marker = curve_style(k)
        ax.errorbar(places, values, yerr=errors, fmt=marker, color=colour, capsize=3, label=label or "measured")
        theory = [(x, found) for x in places if (found := points[x][0].get("theory")) is not None]
        if theory:
            ax.plot(*zip(*theory, strict=True), line, color=colour, label=f"{label}: theory" if label else "theory")
    ax.set_xlabel(axis)
    ax.set_ylabel(quantity)
    ax.legend()
    return figure


def _name(row: Row) -> str:
    return f"{row['analysis']}/{row['quantity']}"


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


def _average(rows: list[Row]) -> tuple[float, float]:
    """Average over replicates, and its standard error: from theirs, or without them from their scatter."""
    values = np.array([row["value"] for row in rows], float)
    errors = [row.get("standard_error") for row in rows]
    if None not in errors:
        return float(values.mean()), math.hypot(*errors) / len(rows)  # type: ignore[arg-type]
    return float(values.mean()), float(values.std(ddof=1) / math.sqrt(len(rows))) if len(rows) > 1 else 0.0
