"""Room for discs: the box, its walls and its solids, divided into cells to find discs and walls that overlap."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from idealgas.jit import inline
from idealgas.physics.arc import ARC, faces_arc, toggles
from idealgas.physics.arc_geometry import NO_ARC, Arc, bounds, nearest_points
from idealgas.scene.solids import NO_SOLIDS

WALL = np.dtype(
    [("x", "f8"), ("y", "f8"), ("along_x", "f8"), ("along_y", "f8"), ("radius", "f8"), ("arc", ARC)], align=True
)
"""Type of a `PlacedWall` in compiled code."""


class PlacedWall(NamedTuple):
    """A wall or a fixed disc.

    Attributes:
        x, y: start of the wall, length.
        along_x, along_y: vector from the start to the end, length.
        radius: radius of a fixed disc, length; 0 for walls.
        arc: the arc; NO_ARC for a straight wall.
    """

    x: float
    y: float
    along_x: float
    along_y: float
    radius: float
    arc: Arc


class Room(NamedTuple):
    """Cells no smaller than the largest diameter, about one per disc, and the walls near each cell.

    Attributes:
        columns: number of cells along x.
        rows: number of cells along y; cell (c, r) has the index c * rows + r.
        width: width of a cell, length.
        height: height of a cell, length.
        period_x: width of the box if its left and right sides are periodic, otherwise 0, length.
        period_y: height of the box if its bottom and top sides are periodic, otherwise 0, length.
        wall: all walls, including images: a list of `PlacedWall`, or (W,) WALL for compiled code.
        wall_start: (cells + 1,) i8, first entry of each cell in `wall_item`.
        wall_item: i8, numbers of the walls that a disc in a cell may touch, cell by cell.
        inside: walls of the closed curves inside which there is no gas, in the form of `wall`.
        outside: walls of the closed curves outside which there is no gas, in the form of `wall`; empty without such
            curves.
        shared: whether discs may overlap each other, because they do not interact.
    """

    columns: int
    rows: int
    width: float
    height: float
    period_x: float
    period_y: float
    wall: Any
    wall_start: Any
    wall_item: Any
    inside: Any
    outside: Any
    shared: bool = False


def make_room(
    box: tuple[float, float],
    radius: np.ndarray,
    periodic: tuple[bool, bool] = (False, False),
    walls: Sequence[Any] = (),
    solids: Mapping[str, Sequence[Any]] = NO_SOLIDS.walls,
    shared: bool = False,
) -> Room:
    """Make the room in which discs are to be placed.

    Args:
        box: width and height, length.
        radius: (N,) radii of the discs, length.
        periodic: whether the sides along x and along y are periodic.
        walls: walls, with the attributes start, end, arc and radius.
        solids: walls of solids, as in `Solids`.
        shared: see `Room`.
    """
    largest = float(radius.max())
    side = max(2 * largest, math.sqrt(box[0] * box[1] / len(radius)))
    shape = max(int(box[0] / side), 1), max(int(box[1] / side), 1)
    size, period = np.array(box) / shape, np.where(periodic, box, 0.0)
    images = _images(_numbers(walls), period)
    near = [_cells_near(wall, shape, size, largest) for wall in images]
    cell = np.concatenate([*near, np.empty(0, np.int64)])
    item = np.repeat(np.arange(len(images)), [len(cells) for cells in near])
    order = np.argsort(cell, kind="stable")
    start = np.searchsorted(cell[order], np.arange(shape[0] * shape[1] + 1))
    placed, inside, outside = map(_placed, (images, _numbers(solids["inside"]), _numbers(solids["outside"])))
    (width, height), (period_x, period_y) = size.tolist(), period.tolist()
    return Room(*shape, width, height, period_x, period_y, placed, start, item[order], inside, outside, shared)


def for_kernels(room: Room) -> Room:
    """Return the same room for compiled code, with arrays in place of the lists of walls."""
    wall, inside, outside = (np.array(a, WALL).view(np.recarray) for a in (room.wall, room.inside, room.outside))
    return room._replace(wall=wall, inside=inside, outside=outside)


def _numbers(walls: Sequence[Any]) -> np.ndarray:
    """Return the start, end, radius and arc of each wall as a row of an array (W, 12)."""
    rows = [(*wall.start, *wall.end, wall.radius, *(wall.arc or NO_ARC)) for wall in walls]
    return np.array(rows, float).reshape(-1, 12)


def _placed(rows: np.ndarray) -> list[PlacedWall]:
    """Convert the rows (W, 12) of `_numbers` to walls."""
    columns = np.hstack((rows[:, :2], rows[:, 2:4] - rows[:, :2], rows[:, 4:]))
    return [PlacedWall(x, y, dx, dy, radius, Arc(*arc)) for x, y, dx, dy, radius, *arc in columns.tolist()]


def _images(walls: np.ndarray, period: np.ndarray) -> np.ndarray:
    """Return the rows (W, 12) of `_numbers` for walls and for their images next to the box along periodic axes."""
    shifts = [[-length, 0.0, length] if length else [0.0] for length in period]
    remainder = np.zeros(walls.shape[1] - 4)
    return np.concatenate([walls + np.array((dx, dy, dx, dy, *remainder)) for dx in shifts[0] for dy in shifts[1]])


def _cells_near(wall: np.ndarray, shape: tuple[int, int], size: np.ndarray, reach: float) -> np.ndarray:
    """Indices of the cells that may contain a point within reach (length) of a wall."""
    ends, reach = wall[:4].reshape(2, 2), reach + wall[4]
    arc = Arc(*wall[5:])
    place = (*ends, arc if arc.radius else None)
    low, high = np.array(bounds(*place)) + np.array(((-reach,), (reach,)))
    ranges = [np.arange(*np.clip((low[a] // size[a], high[a] // size[a] + 1), 0, shape[a]).astype(int)) for a in (0, 1)]
    column, row = (axis.ravel() for axis in np.meshgrid(*ranges))
    centre = (np.column_stack((column, row)) + 0.5) * size
    near = np.hypot(*(centre - nearest_points(centre, *place)).T) <= (reach + np.hypot(*size) / 2) * (1 + 1e-9)
    return (column * shape[1] + row)[near]


def cells_of(room: Room, position: np.ndarray) -> np.ndarray:
    """Indices (M,) of the cells of positions (M, 2), length."""
    column, row = (position / (room.width, room.height)).astype(np.int64).T
    return np.minimum(column, room.columns - 1) * room.rows + np.minimum(row, room.rows - 1)


def is_clear(room: Room, position: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Mask (M,) of the positions (M, 2), length, at which discs of radii (M,) would not overlap walls or solids."""
    x, y = position.T
    clear = ~np.broadcast_to(is_in_solid(room, x, y), x.shape)
    cell = cells_of(room, position)
    for n in np.flatnonzero(np.diff(room.wall_start)[cell]):
        clear[n] &= not meets_wall(room, cell[n], *position[n].tolist(), float(radius[n]))
    return clear


@inline
def meets_wall(room, cell, x, y, reach):
    """Whether a disc of radius `reach` at the point (x, y) in a cell would overlap a wall."""
    for k in range(room.wall_start[cell], room.wall_start[cell + 1]):
        wall = room.wall[room.wall_item[k]]
        contact = reach + wall.radius
        if _squared_distance(wall, x - wall.x, y - wall.y) < contact * contact:
            return True
    return False


@inline
def is_in_solid(room, x, y):
    """Whether the point (x, y) is in a solid; x and y may be numbers or arrays."""
    inside = False
    for k in range(len(room.inside)):
        wall = room.inside[k]
        inside = inside ^ toggles(x - wall.x, y - wall.y, wall.along_x, wall.along_y, wall.arc)
    beyond = len(room.outside) > 0
    for k in range(len(room.outside)):
        wall = room.outside[k]
        beyond = beyond ^ toggles(x - wall.x, y - wall.y, wall.along_x, wall.along_y, wall.arc)
    return inside | beyond


@inline
def _squared_distance(wall, dx, dy):
    """Squared distance, length², of a point from a wall or from the centre of a fixed disc.

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
