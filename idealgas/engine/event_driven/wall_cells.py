"""Wall segments that a disc may touch while its centre is in a cell."""

from typing import NamedTuple

import numpy as np

from idealgas.engine.event_driven.cells import Cells
from idealgas.jit import inline
from idealgas.physics.arc_geometry import bounds, nearest_on_arc
from idealgas.physics.periodic import NO_IMAGES, Periodic, images_to_wall, periodic_axes


class WallCells(NamedTuple):
    """Wall segments of each cell; cell c has the entries start[c] to start[c + 1] - 1.

    Attributes:
        start: (cells + 1,) i4, first entry of each cell.
        item: (entries,) i4, number of the wall segment.
        image: (entries, 2) i4, numbers of box lengths (x, y) from the segment to its image near the cell.
    """

    start: np.ndarray
    item: np.ndarray
    image: np.ndarray


def make_wall_cells(
    segments: np.recarray, arcs: np.recarray | None, periodic: Periodic | None, cells: Cells, largest_radius: float
) -> WallCells:
    """List every active segment in all cells that have a point within the largest radius (length) of the segment.

    A small margin ensures that rounding does not exclude a cell.
    """
    reach = largest_radius * (1 + 1e-9) + 1e-9 * max(cells.width, cells.height)
    across, along = (range(-1, 2) if is_periodic else (0,) for is_periodic in periodic_axes(periodic))
    cell_parts, item_parts = [np.empty(0, np.int64)], [np.empty((0, 3), np.int32)]
    for k in np.flatnonzero(segments.active):
        arc = None if arcs is None or arcs[k].radius == 0 else arcs[k]
        for image in ((x, y) for x in across for y in along):
            nearby = _cells_near(segments[k], arc, image, cells, reach)
            cell_parts.append(nearby)
            item_parts.append(np.full((len(nearby), 3), (k, *image), np.int32))
    cell, item = np.concatenate(cell_parts), np.concatenate(item_parts)
    order = np.argsort(cell, kind="stable")
    start = np.searchsorted(cell[order], np.arange(cells.columns * cells.rows + 1))
    return WallCells(
        start.astype(np.int32), np.ascontiguousarray(item[order, 0]), np.ascontiguousarray(item[order, 1:])
    )


@inline
def images_to_item(walls, entry, disc, periodic):
    """Shift (x, y), in box lengths, from the wall segment of an entry to its image near a disc."""
    if periodic is not None:
        return images_to_wall(periodic, disc, (walls.image[entry, 0], walls.image[entry, 1]))
    return NO_IMAGES


def _cells_near(
    segment: np.record, arc: np.record | None, image: tuple[int, int], cells: Cells, reach: float
) -> np.ndarray:
    """Indices of the cells that may have a point within reach (length) of an image of a segment or arc."""
    reach += segment.radius
    start = np.array([segment.x + image[0] * cells.Lx, segment.y + image[1] * cells.Ly])
    tangent = np.array([segment.tx, segment.ty])
    length = segment.length
    size = np.array([cells.width, cells.height])
    last = np.array([cells.columns, cells.rows]) - 2
    ends = np.array([start, start + length * tangent])
    lowest, highest = np.array(bounds(ends[0], ends[1], arc))
    low = np.clip(np.floor((lowest - reach) / size).astype(int) + 1, 1, last)
    high = np.clip(np.floor((highest + reach) / size).astype(int) + 1, 1, last)
    column, row = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    centre = (np.stack((column, row), axis=-1) - 0.5) * size - start
    if arc is None:
        normal = np.array([-tangent[1], tangent[0]])
        near = np.abs(centre @ normal) <= 0.5 * size @ np.abs(normal) + reach  # no line parallel to it separates them
    else:
        centre = centre.reshape(-1, 2)
        away = np.hypot(*(centre - nearest_on_arc(centre, length * tangent, arc)).T)
        near = (away <= 0.5 * np.hypot(*size) + reach).reshape(row.shape)
    return (row[near] * cells.columns + column[near]).ravel()
