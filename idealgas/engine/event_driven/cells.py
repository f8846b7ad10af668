"""Square-ish cells, at least one diameter wide, with a ring of empty ones around them; each holds a chain of discs."""

import math
from typing import NamedTuple

import numpy as np

from idealgas._jit import aligned, inline

LINK = np.dtype([("next", "i4"), ("previous", "i4")], align=True)
MARGIN = 1e-9
MOST_A_SIDE = 30_000  # a disc's cell is stored in 16 bits

U = np.uintp


class Cells(NamedTuple):
    """head: (rows * columns,) i4, first disc of each cell or -1. link: (N,) LINK. width, height: of a cell, length.

    columns, rows: cells along each axis, ring included. Lx, Ly: box.
    """

    head: np.ndarray
    link: np.ndarray
    width: float
    height: float
    columns: int
    rows: int
    Lx: float
    Ly: float


def discs_per_cell(packing_fraction: float) -> float:
    """Mean filling that was fastest: 0.5 at packing fractions from 0.1 up, 1 at 0.01, 2 at 0.001."""
    return min(max(0.5 * (0.1 / max(packing_fraction, 1e-9)) ** 0.3, 0.5), 4.0)


def make_cells(n: int, box: tuple[float, float], largest_radius: float, filling: float) -> Cells:
    """Empty cells for n discs with about `filling` discs each, never smaller than the largest diameter."""
    Lx, Ly = box
    size = max(math.sqrt(Lx * Ly * filling / n), 2.0 * largest_radius * (1.0 + MARGIN))
    columns, rows = (min(max(int(length / size), 1), MOST_A_SIDE) for length in box)
    link = aligned(n, LINK)
    head = np.full((columns + 2) * (rows + 2), -1, np.int32)
    return Cells(head, link, Lx / columns, Ly / rows, columns + 2, rows + 2, Lx, Ly)


def cell_of(position: np.ndarray, cells: Cells) -> tuple[np.ndarray, np.ndarray]:
    """Column and row (N,) of positions (N, 2); a disc that rounding put outside the box belongs to the cell there."""
    column = np.clip((position[:, 0] / cells.width).astype(np.int64) + 1, 1, cells.columns - 2)
    row = np.clip((position[:, 1] / cells.height).astype(np.int64) + 1, 1, cells.rows - 2)
    return column, row


@inline
def cell_index(cells, disc):
    """Index of a disc's cell."""
    return np.int64(disc.row) * cells.columns + np.int64(disc.column)


@inline
def enter(cells, i, cell):
    """Put disc i at the head of a cell's chain."""
    head = cells.head[U(cell)]
    link = cells.link[U(i)]
    link.next = head
    link.previous = -1
    if head >= 0:
        cells.link[U(head)].previous = i
    cells.head[U(cell)] = i


@inline
def leave(cells, i, cell):
    """Take disc i out of a cell's chain."""
    link = cells.link[U(i)]
    if link.previous >= 0:
        cells.link[U(link.previous)].next = link.next
    else:
        cells.head[U(cell)] = link.next
    if link.next >= 0:
        cells.link[U(link.next)].previous = link.previous
