"""Common style of all pictures: colours that colour-blind readers can distinguish, and panels."""

import io
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from idealgas.files import written
from idealgas.plain import plain

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Palette for colour-blind readers: Okabe & Ito, Color Universal Design (2008)."""

GREY = "#767676"


class Picture(Figure):
    """A figure that notebooks show as it is, whether or not pyplot is in use."""

    def _repr_png_(self) -> bytes:
        """The picture as PNG."""
        show_names(self)
        file = io.BytesIO()
        self.savefig(file, format="png")
        return file.getvalue()


def save(figure: Figure, path: str | os.PathLike[str], force: bool = False) -> None:
    """Write a picture in the format given by the ending of its path; an existing one is replaced only with `force`.

    Raises:
        OutputError: if the file cannot be written.
    """
    kind = Path(path).suffix.lower()
    show_names(figure)
    with written(path, kind, force) as part:
        file = io.BytesIO()  # not every format of matplotlib ends well on a disk that is full
        figure.savefig(file, dpi=150, format=kind.removeprefix("."))
        part.write_bytes(file.getvalue())


def name_rows(ax: Axes, names: Sequence[str], **options: Any) -> None:
    """Names at 0, 1, … of the vertical axis."""
    ax.set_yticks(range(len(names)), list(map(plain, names)), **options)


def show_names(figure: Figure) -> None:
    """Show every text of a figure as it is: `$` and control characters in names have no meaning."""
    for text in figure.findobj(Text):
        text.set_text(plain(text.get_text()))
        if "$" in text.get_text():
            text.set_parse_math(False)


def panels(rows: int, columns: int = 1) -> tuple[Figure, list[Axes]]:
    """Make a figure with panels in rows and columns; the panels are listed row by row."""
    figure = Picture(figsize=(1.5 + 5.5 * columns, 1.2 + 3.0 * rows), layout="constrained")
    axes = [figure.add_subplot(rows, columns, k + 1) for k in range(rows * columns)]
    for ax in axes:
        ax.grid(color="#dddddd", linewidth=0.6)
        ax.set_axisbelow(True)
    return figure, axes


def _repeated(items: tuple[str, ...]) -> Iterable[str]:
    while True:
        yield from items
