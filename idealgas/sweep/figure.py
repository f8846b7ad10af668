"""Figure of one quantity of a sweep against one of its axes."""

import os
from collections.abc import Iterable
from fnmatch import fnmatchcase
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from idealgas.analysis import registry
from idealgas.analysis.core.style import curve_style, panels
from idealgas.errors import UserError, unknown
from idealgas.sweep.results import RESULT, average, result_rows

Row = dict[str, Any]


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
        colour, line, marker = curve_style(k)
        ax.errorbar(places, values, yerr=errors, fmt=marker, color=colour, capsize=3, label=label or "measured")
        known = [
            (x, row["theory"], row["theory_error"]) for x in places if (row := points[x][0]).get("theory") is not None
        ]
        if known:
            at, theory, error = np.array(known).T
            ax.plot(at, theory, line, color=colour, label=f"{label}: theory" if label else "theory")
            ax.fill_between(at, theory - error, theory + error, color=colour, alpha=0.2, linewidth=0)
    ax.set(xlabel=axis, ylabel=quantity)
    ax.legend()
    return figure


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
