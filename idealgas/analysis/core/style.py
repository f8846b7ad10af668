"""Common style of all pictures: colours that colour-blind readers can distinguish, and panels."""

import os
from collections.abc import Iterable

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from idealgas.errors import UserError

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Palette for colour-blind readers: Okabe & Ito, Color Universal Design (2008)."""

GREY = "#767676"


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a picture in the format given by the ending of its path.

    Raises:
        UserError: with exit code 1, if the file cannot be written.
    """
    try:
        figure.savefig(path, dpi=150)
    except OSError as error:
        failure = UserError(f"{path}: cannot be written: {error.strerror}")
        failure.exit_code = 1
        raise failure from error


def panels(rows: int, columns: int = 1) -> tuple[Figure, list[Axes]]:
    """Make a figure with panels in rows and columns; the panels are listed row by row."""
    figure = Figure(figsize=(1.5 + 5.5 * columns, 1.2 + 3.0 * rows), layout="constrained")
    axes = [figure.add_subplot(rows, columns, k + 1) for k in range(rows * columns)]
    for ax in axes:
        ax.grid(color="#dddddd", linewidth=0.6)
        ax.set_axisbelow(True)
    return figure, axes


def _repeated(items: tuple[str, ...]) -> Iterable[str]:
    while True:
        yield from items
