"""Compare the values from sweeps with published values at the same points."""

import json
import math
import os
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from idealgas.errors import unknown
from idealgas.presentation.tables import Number, Table, with_error
from idealgas.sweep.plan import Sweep
from idealgas.sweep.results import average, read_points, rows_of
from idealgas.sweep.tables import Published

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HEADS = ("", "value", "± s.e.", "published", "± error", "deviation (σ)")

FARTHEST = 6.0
"""Largest deviation drawn to scale, σ; larger deviations are drawn at the edge, with their values."""


class PublishedComparison(NamedTuple):
    """A published value and the value from a sweep, averaged over the replicates.

    Attributes:
        point: values of the axes, as text.
        value: value from the sweep.
        error: standard error of the value from the sweep.
        published: published value.
        published_error: standard error of the published value.
    """

    point: str
    value: float
    error: float
    published: float
    published_error: float

    @property
    def deviation(self) -> float:
        """Difference in units of the combined standard error; infinite for two different exact values."""
        off, both = self.value - self.published, math.hypot(self.error, self.published_error)
        return off / both if both else math.copysign(math.inf, off) if off else 0.0


def comparisons(sweep: Sweep, folder: str | os.PathLike[str]) -> Iterator[tuple[Published, list[PublishedComparison]]]:
    """Yield each `[[published]]` table of a sweep with the comparisons at all points that have results.

    Raises:
        UserError: if the sweep has none of the published quantities, or no results.
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
            if replicates := [row for row in rows.get(label, ()) if row["quantity"] == paper.quantity]:
                lines.append(PublishedComparison(label, *average(replicates), value, error))
        yield paper, lines


def published_tables(sweep: Sweep, folder: str | os.PathLike[str]) -> Iterator[Table]:
    """Yield a table for each paper: values from the sweep, published values, and deviations.

    Deviations are in units of the combined standard error.

    Raises:
        UserError: if the sweep has none of the published quantities, or no results.
    """
    for paper, compared in comparisons(sweep, folder):
        lines = [
            (
                comparison.point,
                *with_error(comparison.value, comparison.error),
                *with_error(comparison.published, comparison.published_error),
                Number(comparison.deviation, "+.2f"),
            )
            for comparison in compared
        ]
        yield Table(paper.source, HEADS, lines, notes=tuple(filter(None, (paper.quantity, paper.note))))


def published_figure(sweeps: Iterable[tuple[Sweep, str | os.PathLike[str]]]) -> "Figure":
    """Return a figure of the deviations from published values, one row per paper. sweeps: (sweep, folder) pairs."""
    from idealgas.presentation.style import COLOURS, GREY, WIDTH, name_rows, panels

    papers: dict[str, list[PublishedComparison]] = {}
    for sweep, folder in sweeps:
        for paper, compared in comparisons(sweep, folder):
            papers.setdefault(paper.source, []).extend(compared)
    figure, (ax,) = panels(1)
    figure.set_size_inches(1.6 * WIDTH, 1.2 + 0.4 * len(papers))
    for k, compared in enumerate(papers.values()):
        for j, comparison in enumerate(compared):
            row, off = k + 0.6 * ((j + 0.5) / len(compared) - 0.5), comparison.deviation
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
    ax.set_xlabel("deviation from the published value (combined σ)")
    name_rows(ax, [f"{source} ({len(compared)})" for source, compared in papers.items()], fontsize=8)
    ax.legend()
    return figure


def _label(values: dict[str, Any]) -> str:
    """Return the values of a point on the axes as text, which is the same for values from a plan and from results."""
    return ", ".join(f"{key} = {json.dumps(value)}" for key, value in values.items()) or "base scene"
