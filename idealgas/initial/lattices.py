"""Initial positions on lattices: evenly spaced in a region, or triangular in a whole periodic box."""

from collections.abc import Iterator

import numpy as np

from idealgas.initial.room import Room, is_clear
from idealgas.pairs import near_pairs
from idealgas.physics.periodic import nearest_image
from idealgas.scene.lattice import TriangularLattice


def place_on_lattice(
    room: Room, position: np.ndarray, radius: np.ndarray, bounds: np.ndarray, placed: np.ndarray, ids: np.ndarray
) -> bool:
    """Place discs on a lattice with room for the largest of them at each site; return whether all discs fit.

    Occupied sites are left out, and the discs are distributed evenly over the free sites.

    Args:
        room: region in which the discs are placed.
        position: (N, 2), length, changed in place.
        radius: (N,), length.
        bounds: (4,), limits x0, y0, x1, y1 of the centre of the largest disc, length.
        placed: ids of the discs that are already in place.
        ids: ids of the discs to be placed.
    """
    largest = radius[ids].max()
    wanted = len(ids)
    while (sites := make_lattice(bounds[:2], bounds[2:], 2 * largest, wanted)) is not None:
        reach = np.full(len(sites), largest)
        free = is_clear(room, sites, reach)
        if len(placed):
            discs = np.concatenate((sites, position[placed])), np.concatenate((reach, radius[placed]))
            for i, k in overlapping(room, *discs):
                free[i[(i < len(sites)) & (k >= len(sites))]] = False
                free[k[(k < len(sites)) & (i >= len(sites))]] = False
        sites = sites[free]
        if len(sites) >= len(ids):
            position[ids] = sites[np.arange(len(ids)) * len(sites) // len(ids)]
            return fits(room, position, radius, placed, ids)
        wanted += len(ids) - len(sites)
    return False


def fits(room: Room, position: np.ndarray, radius: np.ndarray, placed: np.ndarray, ids: np.ndarray) -> bool:
    """Whether the discs `ids` do not overlap walls, the discs `placed`, or each other.

    position: (N, 2), length. radius: (N,), length.
    """
    if not is_clear(room, position[ids], radius[ids]).all():
        return False
    both = np.concatenate((ids, placed))
    return not any(((i < len(ids)) | (k < len(ids))).any() for i, k in overlapping(room, position[both], radius[both]))


def overlapping(room: Room, position: np.ndarray, radius: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield, in chunks, the indices (n,) of both discs of all overlapping pairs; position: (M, 2), radius: (M,)."""
    if room.shared:
        return
    for i, k in near_pairs(position, radius, (room.period_x, room.period_y)):
        (dx, dy), contact = (position[i] - position[k]).T, radius[i] + radius[k]
        dx = nearest_image(dx, room.period_x, room.period_x > 0)
        dy = nearest_image(dy, room.period_y, room.period_y > 0)
        overlap = dx * dx + dy * dy < contact * contact
        yield i[overlap], k[overlap]


def make_lattice(low: np.ndarray, high: np.ndarray, diameter: float, sites: int) -> np.ndarray | None:
    """Return a lattice of at least `sites` points (M, 2), no two closer than a diameter; None if there is no room.

    low, high: (2,), lower left and upper right corners of the region, length. The lattice is square if a square lattice
    fits, otherwise triangular. It fills the whole region, and its points are listed row by row from the bottom.
    """
    width, height = high - low + diameter
    rows = np.arange(1, min(int(2 * height / diameter), sites) + 1)
    columns = -(-sites // rows)
    nearest = np.minimum(width / columns, height / rows)
    if nearest.max() >= diameter:
        return _square(low, high, columns[nearest.argmax()], rows[nearest.argmax()], diameter)
    along = (width - diameter) / (columns - 0.5)
    across = (height - diameter) / np.maximum(rows - 1, 1)
    nearest = np.minimum(np.minimum(along, np.hypot(along / 2, across)), np.where(rows > 2, 2 * across, np.inf))
    if nearest.max() >= diameter:
        return _triangular(low, high, columns[nearest.argmax()], rows[nearest.argmax()])
    return None


def _square(low: np.ndarray, high: np.ndarray, columns: int, rows: int, diameter: float) -> np.ndarray:
    """Points (M, 2) of a square lattice, each at the centre of a cell."""
    shape = np.array((columns, rows))
    index = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1).reshape(-1, 2)
    corner = low - diameter / 2
    return np.clip(corner + (index + 0.5) * ((high - low + diameter) / shape), low, high)


def _triangular(low: np.ndarray, high: np.ndarray, columns: int, rows: int) -> np.ndarray:
    """Points (M, 2) of a triangular lattice, every other row shifted by half a spacing."""
    column, row = (axis.ravel() for axis in np.meshgrid(np.arange(columns), np.arange(rows)))
    step = (high - low) / (columns - 0.5, max(rows - 1, 1))
    return np.minimum(low + np.column_stack((column + row % 2 / 2, row)) * step, high)


def lattice_sites(lattice: TriangularLattice) -> np.ndarray:
    """Return the sites (M, 2), length, of a triangular lattice that fills a periodic box.

    Along the rows, the first site is a quarter of a spacing from the lower left corner of the box; across the rows, it
    is half the distance between rows from this corner.
    """
    column, row = (axis.ravel() for axis in np.meshgrid(np.arange(lattice.columns), np.arange(lattice.rows)))
    along, across = (column + row % 2 / 2 + 0.25) * lattice.spacing, (row + 0.5) * lattice.height
    return np.column_stack((along, across) if lattice.axis == 0 else (across, along))
