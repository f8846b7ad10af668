"""Random initial positions at which discs overlap neither each other nor walls.

Discs are added one after another at random positions, the largest discs first. Whenever a position is refused, one of
the discs placed so far makes a Metropolis step. The gas therefore stays close to equilibrium and does not jam at a
packing fraction of 0.547, as it would with random sequential addition alone (Feder, J. Theor. Biol. 87, 237 (1980)). At
low density refusals are rare.
"""

from typing import Any

import numpy as np

from idealgas.initial.room import Room, cells_of, for_kernels, is_in_solid, meets_wall
from idealgas.jit import inline, njit
from idealgas.physics.periodic import nearest_image

REFUSALS_PER_DISC = 3_000
"""Mean number of refused positions per disc after which random placement fails."""

MIN_REFUSALS = 3_000_000
"""Total number of refused positions before which random placement never fails."""

FEW, FEW_REFUSALS = 10_000, 20_000
"""Numbers of discs, with one per cell, and of refused positions up to which Python is faster than compiling."""


def place_at_random(
    room: Room,
    position: np.ndarray,
    radius: np.ndarray,
    bounds: np.ndarray,
    placed: np.ndarray,
    ids: np.ndarray,
    random: np.random.Generator,
    max_refusals: int,
) -> int:
    """Place discs at random in the order of `ids`; return the number of discs that found room.

    A few discs are placed in Python. If there are many, or too many positions are refused, compiled code places the
    rest, with the same result bit for bit.

    Args:
        room: region in which the discs are placed.
        position: (N, 2), length, changed in place.
        radius: (N,), length.
        bounds: (N, 4), limits x0, y0, x1, y1 of the centre of each disc, length.
        placed: ids of the discs that are already in place.
        ids: ids of the discs to be placed.
        random: source of random numbers.
        max_refusals: number of refused positions after which to stop.
    """
    first, behind = _linked_lists(room, position, placed, len(radius))
    lists: tuple[np.ndarray, ...] = first, behind, position[:, 0].copy(), position[:, 1].copy()
    crowding = max(len(radius) / len(first), 1.0)  # mean number of discs per cell, at least 1
    number, refusals = 0, min(int(FEW_REFUSALS / crowding), max_refusals)
    if len(radius) * crowding > FEW:
        refusals = 0
    if refusals:
        plain: Any = room._replace(wall_start=room.wall_start.tolist(), wall_item=room.wall_item.tolist())
        plain_lists = tuple(array.tolist() for array in lists)
        number = insert(plain, plain_lists, radius.tolist(), bounds.tolist(), ids.tolist(), random, number, refusals)
        lists = tuple(np.array(values) for values in plain_lists)
    if number < len(ids) and refusals < max_refusals:
        remainder = max_refusals - refusals
        number = insert_compiled(for_kernels(room), lists, radius, bounds, ids, random, number, remainder)
    position[ids] = np.column_stack(lists[2:])[ids]
    return number


def _linked_lists(room: Room, position: np.ndarray, placed: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """List the discs `placed` by cell.

    Returns the first disc in each cell and, for each of n discs, the next disc in the same cell; -1 if there is none.
    """
    placed = placed[::-1]  # the last come first, because positions are most often blocked by discs on lattices
    cell = cells_of(room, position[placed])
    order = np.argsort(cell, kind="stable")
    cell, placed = cell[order], placed[order]
    same = cell[1:] == cell[:-1]
    first, behind = np.full(room.columns * room.rows, -1), np.full(n, -1)
    behind[placed[:-1][same]] = placed[1:][same]
    heads = np.append(True, ~same)[: len(cell)]
    first[cell[heads]] = placed[heads]
    return first, behind


@inline
def _cell_of(room, x, y):
    """Column and row of the cell that contains the point (x, y)."""
    return min(int(x / room.width), room.columns - 1), min(int(y / room.height), room.rows - 1)


@inline
def _is_free(room, lists, radius, x, y, i):
    """Whether disc i at (x, y) would not overlap walls, solids or other discs."""
    first, behind, xs, ys = lists
    column, row = _cell_of(room, x, y)
    wraps_x, wraps_y = room.period_x > 0.0, room.period_y > 0.0
    for c in range(column - 1, column + 2):
        if not wraps_x and not 0 <= c < room.columns:
            continue
        for r in range(row - 1, row + 2):
            if not wraps_y and not 0 <= r < room.rows:
                continue
            k = first[c % room.columns * room.rows + r % room.rows]
            while k >= 0 and not room.shared:
                dx = nearest_image(x - xs[k], room.period_x, wraps_x)
                dy = nearest_image(y - ys[k], room.period_y, wraps_y)
                contact = radius[i] + radius[k]
                if k != i and dx * dx + dy * dy < contact * contact:
                    return False
                k = behind[k]
    return not (meets_wall(room, column * room.rows + row, x, y, radius[i]) or is_in_solid(room, x, y))


@inline
def _take_out(room, lists, i):
    """Remove disc i from the list of its cell."""
    first, behind, xs, ys = lists
    column, row = _cell_of(room, xs[i], ys[i])
    cell = column * room.rows + row
    if first[cell] == i:
        first[cell] = behind[i]
        return
    k = first[cell]
    while behind[k] != i:
        k = behind[k]
    behind[k] = behind[i]


def insert(room, lists, radius, bounds, ids, random, placed, max_refusals):
    """Place discs at random in the order of `ids`; return the number of discs that are then in place.

    placed: number of discs, the first of `ids`, that are already in place. lists: (first, behind, xs, ys), the linked
    lists of the cells and the (N,) coordinates, length. bounds: (N, 4), see `place_at_random`. In Python these values,
    `radius` and `ids` are lists; in compiled code they are arrays.
    """
    first, behind, xs, ys = lists
    refused = 0
    step = False  # whether a disc that is in place makes a Metropolis step, instead of a new disc being tried
    while placed < len(ids) and (refused < max_refusals or step):
        i = ids[int(placed * random.random())] if step else ids[placed]
        x0, y0, x1, y1 = bounds[i][0], bounds[i][1], bounds[i][2], bounds[i][3]
        if step:
            x = xs[i] + radius[i] * (random.random() - 0.5)
            y = ys[i] + radius[i] * (random.random() - 0.5)
        else:
            x = min(x0 + (x1 - x0) * random.random(), x1)
            y = min(y0 + (y1 - y0) * random.random(), y1)
        inside = not step or (x0 <= x <= x1 and y0 <= y <= y1)
        if inside and _is_free(room, lists, radius, x, y, i):  # a single call: the code is inlined
            if step:
                _take_out(room, lists, i)
            else:
                placed += 1
            column, row = _cell_of(room, x, y)
            cell = column * room.rows + row
            xs[i], ys[i] = x, y
            behind[i] = first[cell]
            first[cell] = i
            step = False
        else:
            refused += not step
            step = not step and placed > 0
    return placed


insert_compiled = njit(insert)
