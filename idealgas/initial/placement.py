"""Positions of discs: on a lattice, or at random without overlap, and clear of the walls.

Random placement is sequential addition, the largest discs first. Whenever a position is refused, one of the discs
placed so far makes a Metropolis step: the gas stays close to equilibrium and does not jam at the packing fraction 0.547
of pure random addition (Feder, J. Theor. Biol. 87, 237 (1980)). At low density refusals are rare.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from idealgas.jit import inline, njit
from idealgas.physics.arc import ARC, faces_arc, toggles
from idealgas.physics.arc_geometry import NO_ARC, Arc, bounds, nearest_points
from idealgas.physics.periodic import nearest_image
from idealgas.scene.lattice import TriangularLattice
from idealgas.scene.solids import NO_SOLIDS

REFUSALS_PER_DISC = 3_000
"""Mean number of refused positions per disc after which random placement fails."""

MIN_REFUSALS = 3_000_000
"""Number of refused positions, of all discs together, before which random placement never fails."""


WALL = np.dtype(
    [("x", "f8"), ("y", "f8"), ("along_x", "f8"), ("along_y", "f8"), ("radius", "f8"), ("arc", ARC)], align=True
)
"""Start of a wall, the way from there to its end, and the radius of a fixed disc, length; and the arc, if it is one."""


class Grid(NamedTuple):
    """Cells no smaller than the largest diameter, each with a linked list of the discs whose centres it contains.

    Attributes:
        first: (columns, rows) i4, index of the first disc of each cell, or -1.
        next: (N,) i4, index of the next disc in the same cell, or -1.
        width: of a cell, length.
        height: of a cell, length.
        period_x: width of the box if its left and right sides are periodic, length; else 0.
        period_y: height of the box if its lower and upper sides are periodic, length; else 0.
        wall: (W,) WALL, every wall, images included.
        wall_start: (columns * rows + 1,) i8, first entry of each cell in `wall_item`; cell (c, r) is c * rows + r.
        wall_item: i8, rows of `wall` that a disc of a cell may touch, cell by cell.
        inside: WALL, closed curves of walls in which no disc is.
        outside: WALL, closed curves of walls outside of which no disc is; no walls if discs are everywhere else.
    """

    first: np.ndarray
    next: np.ndarray
    width: float
    height: float
    period_x: float
    period_y: float
    wall: np.recarray
    wall_start: np.ndarray
    wall_item: np.ndarray
    inside: np.recarray
    outside: np.recarray


def make_grid(
    box: tuple[float, float],
    radius: np.ndarray,
    periodic: tuple[bool, bool] = (False, False),
    walls: Sequence[Any] = (),
    solids: Mapping[str, Sequence[Any]] = NO_SOLIDS.walls,
) -> Grid:
    """Empty grid with about one disc per cell.

    box: width and height, length. radius: (N,), length. periodic: whether the sides along x and along y are periodic.
    walls: with start, end, arc and radius. solids: the walls of solids, as in `Solids`.
    """
    largest = float(radius.max())
    side = max(2 * largest, math.sqrt(box[0] * box[1] / len(radius)))
    shape = [max(int(length / side), 1) for length in box]
    size, period = np.array(box) / shape, np.where(periodic, box, 0.0)
    images = _images(_rows(walls), period)
    near = [_cells_near(wall, shape, size, largest) for wall in images]
    cell = np.concatenate([*near, np.empty(0, np.int64)])
    item = np.repeat(np.arange(len(images)), [len(cells) for cells in near])
    order = np.argsort(cell, kind="stable")
    start = np.searchsorted(cell[order], np.arange(shape[0] * shape[1] + 1))
    first, behind = np.full(shape, -1, np.int32), np.full(len(radius), -1, np.int32)
    made, inside, outside = map(_records, (images, _rows(solids["inside"]), _rows(solids["outside"])))
    (width, height), (period_x, period_y) = size.tolist(), period.tolist()
    return Grid(first, behind, width, height, period_x, period_y, made, start, item[order], inside, outside)


def _rows(walls: Sequence[Any]) -> np.ndarray:
    """Start, end, radius and arc of each wall as numbers (W, 12)."""
    rows = [(*wall.start, *wall.end, wall.radius, *(wall.arc or NO_ARC)) for wall in walls]
    return np.array(rows, float).reshape(-1, 12)


def _records(rows: np.ndarray) -> np.recarray:
    """Walls (W,) WALL of rows of numbers."""
    columns = np.hstack((rows[:, :2], rows[:, 2:4] - rows[:, :2], rows[:, 4:]))
    return columns.view(WALL).reshape(-1).view(np.recarray)


def _images(walls: np.ndarray, period: np.ndarray) -> np.ndarray:
    """Rows (W, 12) of walls and of their images next to the box along periodic axes."""
    shifts = [[-length, 0.0, length] if length else [0.0] for length in period]
    rest = np.zeros(walls.shape[1] - 4)
    return np.concatenate([walls + np.array((dx, dy, dx, dy, *rest)) for dx in shifts[0] for dy in shifts[1]])


def _cells_near(wall: np.ndarray, shape: list[int], size: np.ndarray, reach: float) -> np.ndarray:
    """Indices of the cells of which a point may be within reach (length) of a wall."""
    ends, reach = wall[:4].reshape(2, 2), reach + wall[4]
    arc = Arc(*wall[5:])
    place = (*ends, arc if arc.radius else None)
    low, high = np.array(bounds(*place)) + np.array(((-reach,), (reach,)))
    ranges = [np.arange(*np.clip((low[a] // size[a], high[a] // size[a] + 1), 0, shape[a]).astype(int)) for a in (0, 1)]
    column, row = (axis.ravel() for axis in np.meshgrid(*ranges))
    centre = (np.column_stack((column, row)) + 0.5) * size
    near = np.hypot(*(centre - nearest_points(centre, *place)).T) <= (reach + np.hypot(*size) / 2) * (1 + 1e-9)
    return (column * shape[1] + row)[near]


@inline
def _cell(grid, x, y):
    """Column and row of the cell that contains the point (x, y)."""
    columns, rows = grid.first.shape
    return min(int(x / grid.width), columns - 1), min(int(y / grid.height), rows - 1)


@inline
def _insert(grid, position, i):
    """Insert disc i at the head of its cell's list."""
    column, row = _cell(grid, position[i, 0], position[i, 1])
    grid.next[i] = grid.first[column, row]
    grid.first[column, row] = i


@inline
def _remove(grid, position, i):
    """Remove disc i from its cell's list."""
    column, row = _cell(grid, position[i, 0], position[i, 1])
    if grid.first[column, row] == i:
        grid.first[column, row] = grid.next[i]
        return
    k = grid.first[column, row]
    while grid.next[k] != i:
        k = grid.next[k]
    grid.next[k] = grid.next[i]


@inline
def _around(index, count, period):
    """Range of the indices of a column or row and its neighbours, not yet wrapped along a periodic axis."""
    return (index - 1, index + 2) if period > 0.0 else (max(index - 1, 0), min(index + 2, count))


@inline
def _is_free(grid, position, radius, x, y, reach, i):
    """Whether a disc of radius `reach` at (x, y) would overlap no wall, no solid and no disc of the grid but disc i."""
    columns, rows = grid.first.shape
    column, row = _cell(grid, x, y)
    for c in range(*_around(column, columns, grid.period_x)):
        for r in range(*_around(row, rows, grid.period_y)):
            k = grid.first[c % columns, r % rows]
            while k >= 0:
                dx = nearest_image(x - position[k, 0], grid.period_x, grid.period_x > 0.0)
                dy = nearest_image(y - position[k, 1], grid.period_y, grid.period_y > 0.0)
                contact = reach + radius[k]
                if k != i and dx * dx + dy * dy < contact * contact:
                    return False
                k = grid.next[k]
    return _is_clear(grid, column * rows + row, x, y, reach)


@inline
def _is_clear(grid, cell, x, y, reach):
    """Whether a disc of radius `reach` at (x, y), a point of the cell, would overlap no wall and is in no solid."""
    for k in range(grid.wall_start[cell], grid.wall_start[cell + 1]):
        wall = grid.wall[grid.wall_item[k]]
        contact = reach + wall.radius
        if _squared_distance(wall, x - wall.x, y - wall.y) < contact * contact:
            return False
    return not (_encloses(grid.inside, x, y) or (len(grid.outside) > 0 and not _encloses(grid.outside, x, y)))


@inline
def _encloses(walls, x, y):
    """Whether closed curves of walls enclose the point (x, y)."""
    found = False
    for k in range(len(walls)):
        wall = walls[k]
        found ^= toggles(x - wall.x, y - wall.y, wall.along_x, wall.along_y, wall.arc)
    return found


@inline
def _squared_distance(wall, dx, dy):
    """Squared distance, length², of a point from a wall, from the centre of a fixed disc.

    dx, dy: position of the point relative to the start of the wall, length.
    """
    squared = wall.along_x * wall.along_x + wall.along_y * wall.along_y
    if wall.arc.radius > 0.0:
        away_x = dx - wall.arc.x
        away_y = dy - wall.arc.y
        distance = math.sqrt(away_x * away_x + away_y * away_y)
        if faces_arc(away_x, away_y, distance, wall.arc):
            return (distance - wall.arc.radius) * (distance - wall.arc.radius)
        share = 1.0 if 2.0 * (dx * wall.along_x + dy * wall.along_y) > squared else 0.0  # the nearer end
    else:
        along = dx * wall.along_x + dy * wall.along_y
        share = min(max(along / squared, 0.0), 1.0) if squared > 0.0 else 0.0
    dx -= share * wall.along_x
    dy -= share * wall.along_y
    return dx * dx + dy * dy


@njit
def insert_given(grid, position, ids):
    """Insert discs whose positions have been checked; those in contact may overlap by rounding."""
    for i in ids:
        _insert(grid, position, i)


@njit
def insert(grid, position, radius, ids):
    """Insert discs at their positions; return their number before the first that would overlap."""
    for n, i in enumerate(ids):
        if not _is_free(grid, position, radius, position[i, 0], position[i, 1], radius[i], i):
            return n
        _insert(grid, position, i)
    return len(ids)


@njit
def find_free(grid, position, radius, sites, reach, free):
    """Set the mask `free` (M,) of the sites (M, 2) where a disc of radius `reach` would overlap no disc and no wall."""
    for n in range(len(sites)):
        free[n] = _is_free(grid, position, radius, sites[n, 0], sites[n, 1], reach, -1)


@njit
def insert_randomly(grid, position, radius, bounds, ids, rng, max_refusals):
    """Place discs at random in the order of `ids`; return the number of those that found room.

    bounds: (N, 4) x0, y0, x1, y1 for each disc's centre, length. max_refusals: of positions, after
    which to stop.
    """
    placed = 0
    refused = 0
    step = False  # whether a disc in place makes a step, instead of a new one that looks for room
    while placed < len(ids) and (refused < max_refusals or step):
        i = ids[int(placed * rng.random())] if step else ids[placed]
        x0, y0, x1, y1 = bounds[i, 0], bounds[i, 1], bounds[i, 2], bounds[i, 3]
        if step:
            x = position[i, 0] + radius[i] * (rng.random() - 0.5)
            y = position[i, 1] + radius[i] * (rng.random() - 0.5)
        else:
            x = min(x0 + (x1 - x0) * rng.random(), x1)
            y = min(y0 + (y1 - y0) * rng.random(), y1)
        inside = not step or (x0 <= x <= x1 and y0 <= y <= y1)
        if inside and _is_free(grid, position, radius, x, y, radius[i], i):  # once: it is long, and inlined
            if step:
                _remove(grid, position, i)
            else:
                placed += 1
            position[i, 0], position[i, 1] = x, y
            _insert(grid, position, i)
            step = False
        else:
            refused += not step
            step = not step and placed > 0
    return placed


def insert_on_lattice(grid, position, radius, bounds, ids) -> bool:
    """Place discs on a lattice spaced for the largest of them; return whether there is room for all.

    bounds: (4,) x0, y0, x1, y1 for the centre of the largest disc, length. Sites where discs are already are left out;
    the free sites are used evenly.
    """
    largest = radius[ids].max()
    wanted = len(ids)
    while (sites := make_lattice(bounds[:2], bounds[2:], 2 * largest, wanted)) is not None:
        free = np.empty(len(sites), bool)
        find_free(grid, position, radius, sites, largest, free)
        sites = sites[free]
        if len(sites) >= len(ids):
            position[ids] = sites[np.arange(len(ids)) * len(sites) // len(ids)]
            return insert(grid, position, radius, ids) == len(ids)
        wanted += len(ids) - len(sites)
    return False


def make_lattice(low: np.ndarray, high: np.ndarray, diameter: float, sites: int) -> np.ndarray | None:
    """At least `sites` points (M, 2) from `low` to `high`, no two closer than a diameter; None if there is no room.

    low, high: (2,), length. The lattice is square if that fits, else triangular; its points are in rows from below, and
    fill the whole region.
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
    """Points (M, 2) of a square lattice, each in the middle of a cell of its own."""
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
    """Sites (M, 2) of a triangular lattice in a periodic box, half a step from its lower left corner."""
    column, row = (axis.ravel() for axis in np.meshgrid(np.arange(lattice.columns), np.arange(lattice.rows)))
    along, across = (column + row % 2 / 2 + 0.25) * lattice.spacing, (row + 0.5) * lattice.height
    return np.column_stack((along, across) if lattice.axis == 0 else (across, along))
