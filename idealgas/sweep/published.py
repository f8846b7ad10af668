"""Values of a sweep next to those that papers publish for the same points."""

import json
import math
import os
from collections.abc import Iterator
from typing import Any

from idealgas.analysis.core.tables import Number, Table, with_error
from idealgas.errors import unknown
from idealgas.sweep.plan import Sweep
from idealgas.sweep.results import average, read_points, rows_of

HEADS = ("", "value", "± s.e.", "published", "± error", "deviation (σ)")


def published_tables(sweep: Sweep, folder: str | os.PathLike[str]) -> Iterator[Table]:
    """Yield a table for each paper: averages over replicates, and their deviation in units of both errors together.

    Raises:
        UserError: if the sweep has no such quantity, or no results.
    """
    rows: dict[str, list[dict[str, Any]]] = {}
    for point in read_points(folder):
        rows.setdefault(_label(point["values"]), []).extend(rows_of(point))
    names = list(dict.fromkeys(row["quantity"] for of_point in rows.values() for row in of_point))
    labels = list(dict.fromkeys(_label(point.values) for point in sweep.points))
    for paper in sweep.published:
        if paper.quantity not in names:
            raise unknown("quantity", paper.quantity, names)
        lines = []
        for label, value, error in zip(labels, paper.values, paper.errors or (0.0,) * len(labels), strict=True):
            if found := [row for row in rows.get(label, ()) if row["quantity"] == paper.quantity]:
                own, own_error = average(found)
                both = math.hypot(error, own_error)
                off = (own - value) / both if both else None
                lines.append((label, *with_error(own, own_error), *with_error(value, error), Number(off, "+.2f")))
        yield Table(paper.source, HEADS, lines, notes=(paper.quantity,))


def _label(values: dict[str, Any]) -> str:
    """Values of the axes of a point, as text; those of the file of a sweep and those of results have the same."""
    return ", ".join(f"{key} = {json.dumps(value)}" for key, value in values.items()) or "base scene"
