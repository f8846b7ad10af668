"""Common style of all figures: panels, and colours that colour-blind readers can distinguish."""

import io
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.transforms import ScaledTranslation

from idealgas.errors import plain
from idealgas.files import written

if TYPE_CHECKING:
    from idealgas.statistics.estimates import Estimate

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Palette for colour-blind readers: Okabe & Ito, Color Universal Design (2008)."""

LINES, MARKERS = ("-", "--", "-.", ":"), ("o", "s", "^", "D")
"""Line styles and markers that distinguish curves of the same colour."""

BLACK, GREY = "#000000", "#767676"
GRID = "#dddddd"
BAND = 0.2
"""Opacity of an error band."""

WIDTH, HEIGHT = 5.2, 3.2
"""Size of a panel, inches."""

BELOW = 30
"""Distance between a legend and the axis above it, points."""

LONG_LABEL = 30
"""Number of characters above which the labels of a legend are placed in a single column."""

LEGEND_ROWS = 8
"""Largest number of rows in a legend; many more would leave no room for the panel above."""

LABEL_CHARACTERS = 48
"""Number of characters after which a label is continued on the next line."""

DPI = 200
TITLE_CHARACTERS, TITLE_LINES = 10, 2
"""Number of characters per inch in a title, and largest number of its lines."""


def curve_style(k: int) -> tuple[str, str, str]:
    """Return the colour, line style and marker of curve k; curves of one colour differ in line style and marker."""
    again, colour = divmod(k, len(COLOURS))
    return COLOURS[colour], LINES[again % len(LINES)], MARKERS[again % len(MARKERS)]


@dataclass(frozen=True)
class Strips:
    """Strips of the box in a panel that shows the density of discs.

    Attributes:
        axis: axis perpendicular to the strips, 0 for x or 1 for y.
        first: position of the first edge, length.
        last: position of the last edge, length.
        number: number of strips.
        area: area of one strip, length².
    """

    axis: int
    first: float
    last: float
    number: int
    area: float


class Panel(Axes):
    """Panel of a figure, with the label of its vertical axis above it and its legend below it.

    Attributes:
        in_time: whether the horizontal axis is the time of the run, so that a page can mark an instant on it.
        strips: strips in which a page can show the density at an instant; None for other panels.
    """

    in_time = False
    strips: Strips | None = None

    def set_ylabel(self, ylabel: str, *args: Any, **options: Any) -> Text:  # type: ignore[override]
        """Write the label of the vertical axis above the panel."""
        return self.set_title(ylabel, loc="left", fontsize="medium")

    def get_ylabel(self) -> str:
        """Return the label of the vertical axis that was set with `set_ylabel`."""
        return self.get_title(loc="left")

    def entries(self) -> tuple[dict[str, Any], int]:
        """Return the entries of the legend, without repeated labels, and its number of columns; long legends are cut.

        An entry is the matplotlib artist of a curve; the keys are the labels.
        """
        entries: dict[str, Any] = {}
        for handle, label in zip(*self.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
        columns = 1 if max(map(len, entries), default=0) > LONG_LABEL else 2
        if len(entries) > (most := LEGEND_ROWS * columns):
            shown = list(entries.items())[: most - 1]
            entries = dict(shown) | {f"and {len(entries) - most + 1} more": Line2D([], [], linestyle="none")}
        return entries, columns

    def legend(self, *args: Any, **options: Any) -> Legend:
        """Draw the legend of the curves below the panel."""
        entries, columns = self.entries()
        if not entries:  # matplotlib draws no legend for empty lists
            return super().legend(handles=[])
        below = self.transAxes + ScaledTranslation(0, -BELOW / 72, self.figure.dpi_scale_trans)
        place = {"loc": "upper left", "bbox_to_anchor": (-0.02, 0), "bbox_transform": below, "ncols": columns}
        style = {"handles": list(entries.values()), "labels": list(entries), "frameon": False, "fontsize": 9}
        legend = super().legend(*args, **(options | place | style))
        for text in legend.get_texts():
            text.set_text(fill(text.get_text(), LABEL_CHARACTERS))
        return legend

    def theory(
        self, x: Any, value: Any, error: Any = 0.0, label: str | None = "theory", color: str = BLACK,
        linestyle: str = "--", marker: str = "",
    ) -> None:  # fmt: skip
        """Draw a theoretical curve as a line within a band of its error (one standard deviation).

        x: positions of the values, or None for a constant. marker: marker of the values, for use if the line between
        them is not theory.
        """
        if x is None:
            self.axhline(value, color=color, linestyle="--", linewidth=0.9, label=label, zorder=3)
            if error > 0:
                self.axhspan(value - error, value + error, color=color, alpha=BAND, linewidth=0)
            return
        self.plot(x, value, linestyle, marker=marker, ms=4, color=color, linewidth=0.9, label=label, zorder=3)
        if np.any(np.asarray(error) > 0):
            self.fill_between(x, value - error, value + error, color=color, alpha=BAND, linewidth=0)

    def theory_of_row(self, row: int, estimate: "Estimate", label: str | None = "theory") -> None:
        """Draw the theoretical value of an estimate, if it has one, and its error band in the row of this estimate."""
        if estimate.theory is None:
            return
        ends, error = [row - 0.35, row + 0.35], estimate.theory_error
        self.plot([estimate.theory] * 2, ends, color=COLOURS[1], linewidth=2, label=label)
        self.fill_betweenx(
            ends, estimate.theory - error, estimate.theory + error, color=COLOURS[1], alpha=BAND, linewidth=0
        )

    def time_axis(self) -> None:
        """Declare that the horizontal axis is the time of the run."""
        self.in_time = True
        self.set_xlabel("t (time)")


class Picture(Figure):
    """Figure that notebooks display whether or not pyplot is in use."""

    def _repr_png_(self) -> bytes:
        """Return the figure as PNG."""
        disable_mathtext(self)
        file = io.BytesIO()
        self.savefig(file, format="png")
        return file.getvalue()


def save(figure: Figure, path: str | os.PathLike[str], force: bool = False) -> None:
    """Write a figure in the format given by the extension of its path; an existing file is replaced only with `force`.

    Raises:
        OutputError: if the file cannot be written.
    """
    kind = Path(path).suffix.lower()
    disable_mathtext(figure)
    with written(path, kind, force) as part:
        file = io.BytesIO()  # not every format of matplotlib fails cleanly on a full disk
        figure.savefig(file, dpi=DPI, format=kind.removeprefix("."))
        part.write_bytes(file.getvalue())


def name_rows(ax: Axes, names: Sequence[str], **options: Any) -> None:
    """Write names at 0, 1, … on the vertical axis."""
    ax.set_yticks(range(len(names)), list(map(plain, names)), **options)


def disable_mathtext(figure: Figure) -> None:
    """Show all text of a figure literally, so that `$` and control characters in names have no special meaning."""
    for text in figure.findobj(Text):
        text.set_text("\n".join(map(plain, text.get_text().split("\n"))))
        if "$" in text.get_text():
            text.set_parse_math(False)


def add_title(figure: Figure, title: str) -> Figure:
    """Write a title above a figure, in at most TITLE_LINES lines, and return the figure."""
    width = int(TITLE_CHARACTERS * figure.get_figwidth())
    text = fill(plain(title), width, max_lines=TITLE_LINES, placeholder=" …")
    figure.suptitle(text, x=0.02, ha="left", weight="bold", size="medium")
    return figure


def panels(rows: int, columns: int = 1) -> tuple[Figure, list[Panel]]:
    """Return a figure with panels in rows and columns; the panels are listed row by row."""
    figure = Picture(figsize=(WIDTH * columns, 0.3 + HEIGHT * rows), layout="constrained")
    axes = [cast(Panel, figure.add_subplot(rows, columns, k + 1, axes_class=Panel)) for k in range(rows * columns)]
    for ax in axes:
        ax.grid(color=GRID, linewidth=0.6)
        ax.ticklabel_format(useOffset=False)
        ax.set_axisbelow(True)
        ax.spines[["top", "right"]].set_visible(False)
        ax.spines[["bottom", "left"]].set_in_layout(False)  # tick labels extend beyond them
        ax.yaxis.set_label_coords(0, 0)  # so that the position of an absent label is not computed repeatedly
    return figure, axes


def block_figure(names: Mapping[tuple[tuple[float, float], ...], str], length: float, unit: str) -> Figure:
    """Draw errors estimated from blocks, divided by the stated errors, against the length of the blocks.

    Where a curve still rises, slower fluctuations are not resolved.

    names: names of estimates by their `Estimate.blocks`. length: length of the series of which the block lengths are
    fractions. unit: unit of this length.
    """
    figure, axes = panels(-(-len(names) // 2), min(len(names), 2))
    for ax, (blocks, name) in zip(axes, names.items(), strict=False):
        share, error = np.array(blocks).T
        ax.axhline(1, color=COLOURS[1])
        ax.errorbar(share * length, error, error * np.sqrt(share / 2), color=COLOURS[0], fmt="o-", capsize=3)
        ax.set(xscale="log", xlabel=f"length of blocks ({unit})", ylabel=f"{name}: error / stated error")
        ax.set_ylim(bottom=0)
    for ax in axes[len(names) :]:
        ax.set_axis_off()
    return figure
