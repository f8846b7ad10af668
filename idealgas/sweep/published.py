"""Values of sweeps next to those that papers publish for the same points."""

import json
import math
import os
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from idealgas.analysis.core.tables import Number, Table, with_error
from idealgas.errors import unknown
from idealgas.sweep.plan import Sweep
from idealgas.sweep.results import average, read_points, rows_of
from idealgas.sweep.tables import Published

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HEADS = ("", "value", "± s.e.", "published", "± error", "deviation (σ)")

FARTHEST = 6.0
"""Largest deviation with a place of its own in the figure, σ; the figure names larger ones."""


class Comparison(NamedTuple):
    """A published value and that of a sweep, which is the average over its replicates.

    point: values of the axes, as text. value, error: of the sweep. published, published_error: of the paper.
    """

    point: str
    value: float
    error: float
    published: float
    published_error: float

    @property
    def deviation(self) -> float:
        """Difference in units of both errors together, σ; infinite for two exact values that differ."""
        off, both = self.value - self.published, math.hypot(self.error, self.published_error)
        return off / both if both else math.copysign(math.inf, off) if off else 0.0


def comparisons(sweep: Sweep, folder: str | os.PathLike[str]) -> Iterator[tuple[Published, list[Comparison]]]:
    """Yield each table `[[published]]` of a sweep with its values at the points that have results.

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
                lines.append(Comparison(label, *average(found), value, error))
        yield paper, lines


def published_tables(sweep: Sweep, folder: str | os.PathLike[str]) -> Iterator[Table]:
    """Yield a table of each paper: own and published values, and their deviation in units of both errors together.

    Raises:
        UserError: if the sweep has no such quantity, or no results.
    """
    for paper, found in comparisons(sweep, folder):
        lines = [
            (
                one.point,
                *with_error(one.value, one.error),
                *with_error(one.published, one.published_error),
                Number(one.deviation, "+.2f"),
            )
            for one in found
        ]
        yield Table(paper.source, HEADS, lines, notes=tuple(filter(None, (paper.quantity, paper.note))))


def published_figure(sweeps: Iterable[tuple[Sweep, str | os.PathLike[str]]]) -> "Figure":
    """Figure of the deviations of all values of sweeps, each with its folder, from published ones: a row per paper."""
    from idealgas.analysis.core.style import COLOURS, GREY, WIDTH, name_rows, panels

    papers: dict[str, list[Comparison]] = {}
    for sweep, folder in sweeps:
        for paper, found in comparisons(sweep, folder):
            papers.setdefault(paper.source, []).extend(found)
    figure, (ax,) = panels(1)
    figure.set_size_inches(1.6 * WIDTH, 1.2 + 0.4 * len(papers))
    for k, found in enumerate(papers.values()):
        for j, one in enumerate(found):
            row, off = k + 0.6 * ((j + 0.5) / len(found) - 0.5), one.deviation
            if abs(off) <= FARTHEST:
                ax.plot(off, row, "o", ms=4, color=COLOURS[0])
            else:
                side = math.copysign(1, off)
                ax.plot(side * FARTHEST, row, ">" if side > 0 else "<", ms=6, color=COLOURS[1])
                ax.annotate(
                    f"{off:+.1f} ", (side * FARTHEST, row), (-8 * side, 0), textcoords="offset points",
                    ha="right" if side > 0 else "left", va="center", fontsize=8,
                )  # fmt: skip
    for width, alpha in ((3, 0.15), (1, 0.4)):
        ax.axvspan(-width, width, color=GREY, alpha=alpha, linewidth=0, label=f"±{width}σ")
    ax.set(xlim=(-1.08 * FARTHEST, 1.08 * FARTHEST), ylim=(len(papers) - 0.4, -0.6))
    ax.set_xlabel("own value - published value (σ, both errors together)")
    name_rows(ax, [f"{source} ({len(found)})" for source, found in papers.items()], fontsize=8)
    ax.legend()
    return figure


def _label(values: dict[str, Any]) -> str:
    """Values of the axes of a point, as text; those of the file of a sweep and those of results have the same."""
    return ", ".join(f"{key} = {json.dumps(value)}" for key, value in values.items()) or "base scene"
