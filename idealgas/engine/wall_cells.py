"""Which wall segments a disc may touch while its centre is in a cell."""

from typing import NamedTuple

import numpy as np

from idealgas.engine.cells import Cells
from idealgas.physics.segment import Segments


class WallCells(NamedTuple):
    """The segments of cell c are item[start[c] : start[c + 1]]; both i4."""

    start: np.ndarray
    item: np.ndarray


def make_wall_cells(segments: Segments, cells: Cells, largest_radius: float) -> WallCells:
    """Every active segment, in every cell of which some point is within the largest radius of it or nearly so."""
    reach = largest_radius * (1 + 1e-9) + 1e-9 * max(cells.width, cells.height)
    cell_parts, item_parts = [], []
    for k in np.flatnonzero(segments.active):
        found = _cells_near(segments, int(k), cells, reach)
        cell_parts.append(found)
        item_parts.append(np.full(len(found), k, np.int32))
    cell = np.concatenate([*cell_parts, np.empty(0, np.int64)])
    item = np.concatenate([*item_parts, np.empty(0, np.int32)])
    order = np.argsort(cell, kind="stable")
    start = np.searchsorted(cell[order], np.arange(cells.columns * cells.rows + 1))
    return WallCells(start.astype(np.int32), item[order])


def _cells_near(segments: Segments, k: int, cells: Cells, reach: float) -> np.ndarray:
    """Indices of the cells whose centre is near enough to segment k for a corner to be within reach."""
    start = np.array([segments.x[k], segments.y[k]])
    tangent = np.array([segments.tx[k], segments.ty[k]])
    length = segments.length[k]
    size = np.array([cells.width, cells.height])
    last = np.array([cells.columns, cells.rows]) - 2
    ends = np.array([start, start + length * tangent])
    low = np.clip(np.floor((ends.min(axis=0) - reach) / size).astype(int) + 1, 1, last)
    high = np.clip(np.floor((ends.max(axis=0) + reach) / size).astype(int) + 1, 1, last)
    column, row = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    centre = (np.stack((column, row), axis=-1) - 0.5) * size - start
    along = np.clip(centre @ tangent, 0.0, length)
    distance = np.hypot(*np.moveaxis(centre - along[..., None] * tangent, -1, 0))
    near = distance <= reach + 0.5 * np.hypot(*size)
    return (row[near] * cells.columns + column[near]).ravel()
