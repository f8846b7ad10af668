"""Cells for the neighbour search: nearly square, at least one diameter wide, and surrounded by a ring of empty cells.

Each cell has a doubly linked list of the discs whose centres it contains. Discs that are far larger than the rest have
separate, coarse cells: Ogarko & Luding, Comput. Phys. Commun. 183, 931 (2012).
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.jit import aligned, inline

LINK = np.dtype(
    [
        ("next", "i4"), ("previous", "i4"),  # indices of discs in the same cell, or -1
        ("column", "i2"), ("row", "i2"),  # column and row of the cell
    ],
    align=True,
)  # fmt: skip
MARGIN = 1e-9  # smallest relative excess of a cell's width over the largest diameter
MOST_A_SIDE = 30_000  # largest number of columns or rows: a disc's column and row are stored in 16 bits
OTHER_WORK = 20.0  # number of discs that could be searched in the time that the rest of an event takes
WORTH_SPLITTING = 0.5  # coarse cells are used if they reduce the time per event below this fraction

U = np.uintp


class Cells(NamedTuple):
    """Cells for the neighbour search.

    Attributes:
        head: (rows * columns,) i4, index of the first disc of each cell, or -1.
        link: (N,) LINK, the cell of each disc, and the next and the previous disc in this cell.
        width: width of a cell, length.
        height: height of a cell, length.
        columns: number of cells along x, ring included.
        rows: number of cells along y, ring included.
        Lx: width of the box, length.
        Ly: height of the box, length.
    """

    head: np.ndarray
    link: np.ndarray
    width: float
    height: float
    columns: int
    rows: int
    Lx: float
    Ly: float


class CoarseCells(NamedTuple):
    """Cells for discs that are far larger than the rest; each covers ratio × ratio fine cells.

    A coarse cell is at least as wide as the sum of the largest radius of the large discs and that of the small discs.
    Large discs therefore meet small discs in the same or adjacent coarse cells, and other large discs at most two
    coarse cells away.

    Attributes:
        cells: the coarse cells; they share the array `link` with the fine cells.
        ratio: number of fine columns, and of fine rows, in a coarse cell.
        limit: radius above which a disc is in the coarse cells, length.
    """

    cells: Cells
    ratio: int
    limit: float


def discs_per_cell(packing_fraction: float) -> float:
    """Return the optimal mean number of discs per cell: 0.4 at packing fractions of 0.1 and above, 0.8 at 0.01."""
    return min(max(0.4 * (0.1 / max(packing_fraction, 1e-9)) ** 0.3, 0.4), 4.0)


def make_cells(n: int, box: tuple[float, float], largest_radius: float, filling: float) -> Cells:
    """Make empty cells for n discs, never smaller than the largest diameter.

    box: width and height, length. largest_radius: length. filling: mean number of discs per cell.
    """
    Lx, Ly = box
    size = max(math.sqrt(Lx * Ly * filling / n), 2.0 * largest_radius * (1.0 + MARGIN))
    columns, rows = (min(max(int(length / size), 1), MOST_A_SIDE) for length in box)
    link = aligned(n, LINK)
    head = np.full((columns + 2) * (rows + 2), -1, np.int32)
    return Cells(head, link, Lx / columns, Ly / rows, columns + 2, rows + 2, Lx, Ly)


def make_levels(radius: np.ndarray, box: tuple[float, float], filling: float) -> tuple[Cells, CoarseCells | None]:
    """Make empty cells for the discs, and coarse cells for the largest discs if these speed up the search.

    radius: (N,), length. box: width and height, length. filling: mean number of discs per cell.
    """
    n, limit = len(radius), split_radius(radius, box[0] * box[1], filling)
    small = radius[radius <= limit]
    fine = make_cells(n, box, float(small.max()), filling)
    if len(small) == n:
        return fine, None
    coarse = make_cells(n, box, (float(radius.max()) + float(small.max())) / 2, filling)
    across, along = coarse.columns - 2, coarse.rows - 2
    ratio = min((fine.columns - 2) // across, (fine.rows - 2) // along)
    columns, rows = ratio * across, ratio * along
    head = np.full((columns + 2) * (rows + 2), -1, np.int32)
    fine = Cells(head, fine.link, box[0] / columns, box[1] / rows, columns + 2, rows + 2, *box)
    return fine, CoarseCells(coarse._replace(link=fine.link), ratio, limit)


def split_radius(radius: np.ndarray, area: float, filling: float) -> float:
    """Return the radius (length) above which discs belong in coarse cells; infinite if these are not worthwhile.

    The time per event is assumed to be a constant plus a term proportional to the number of discs in the cells that are
    searched, and the event rate of a disc to be proportional to the sum of its radius and the mean radius.
    """
    density, largest, reach = len(radius) / area, float(radius.max()), radius + radius.mean()

    def searched(limit: float) -> float:
        """Time per event if larger discs are in coarse cells, in units of the time for searching one disc."""
        large = radius > limit
        small = radius[~large].max()
        fine, coarse = (max(filling / density, (small + r) ** 2) for r in (small, largest))
        share = reach[large].sum() / reach.sum()
        return OTHER_WORK + 9.0 * float(density * fine + (share * density + large.sum() / area) * coarse)

    limits = [limit for limit in (largest * 0.5 ** np.arange(1, 40)).tolist() if limit >= radius.min()]
    best = min(limits, key=searched, default=math.inf)
    return best if limits and searched(best) < WORTH_SPLITTING * searched(math.inf) else math.inf


def cell_of(position: np.ndarray, cells: Cells) -> tuple[np.ndarray, np.ndarray]:
    """Return the columns and rows (N,) of the cells that contain positions (N, 2), length.

    A disc that is outside the box because of rounding belongs to the nearest cell.
    """
    column, row = (position / (cells.width, cells.height)).astype(np.int64).T + 1
    return np.minimum(np.maximum(column, 1), cells.columns - 2), np.minimum(np.maximum(row, 1), cells.rows - 2)


def order_by_cell(position: np.ndarray, cells: Cells) -> np.ndarray:
    """Return the indices (N,) that sort discs at positions (N, 2), length, by cell, row by row."""
    column, row = cell_of(position, cells)
    return np.argsort(row * cells.columns + column, kind="stable")


@inline
def own_cells(cells, coarse, disc):
    """Return the cells, coarse or fine, in which a disc is listed."""
    if coarse is not None:
        return coarse.cells if disc.r > coarse.limit else cells
    return cells


@inline
def find_cell(cells, i, disc):
    """Store in disc i's link the column and row of the cell that contains its centre; see `cell_of`."""
    link = cells.link[U(i)]
    link.column = min(max(np.int64(disc.x / cells.width) + 1, 1), cells.columns - 2)
    link.row = min(max(np.int64(disc.y / cells.height) + 1, 1), cells.rows - 2)


@inline
def enter(cells, i):
    """Insert disc i at the head of its cell's list. To avoid branches, i stands in for a missing neighbour."""
    link = cells.link[U(i)]
    cell = np.int64(link.row) * cells.columns + np.int64(link.column)
    head = cells.head[U(cell)]
    cells.link[U(head if head >= 0 else i)].previous = i
    link.next = head
    link.previous = -1
    cells.head[U(cell)] = i


@inline
def leave(cells, i):
    """Remove disc i from its cell's list, without branches as in `enter`."""
    link = cells.link[U(i)]
    cell = np.int64(link.row) * cells.columns + np.int64(link.column)
    before = link.previous
    behind = link.next
    cells.link[U(behind if behind >= 0 else i)].previous = before
    cells.link[U(before if before >= 0 else i)].next = behind
    head = cells.head[U(cell)]
    cells.head[U(cell)] = behind if before < 0 else head
