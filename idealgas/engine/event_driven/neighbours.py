"""Search for the discs that a disc may meet, in the cells around it and, if sizes differ greatly, in coarse cells."""

import math

import numpy as np

from idealgas.engine.event_driven.prediction import SIDE_OF_BOX
from idealgas.engine.event_driven.state import record_image
from idealgas.jit import inline, noinline

U = np.uintp


@inline
def wrapped_index(index, count, is_periodic):
    """Return the column or row of a cell, wrapped along a periodic axis, and the image of the cell: -1, 0 or 1.

    count: number of columns or rows, including the ring around the box.
    """
    if is_periodic:
        if index < 1:
            return index + count - 2, -1
        if index > count - 2:
            return index - (count - 2), 1
    return index, 0


@noinline
def append_wrapped_line(cells, candidates, images, count, column, row, along_y, periodic):
    """Do the work of `append_line` for cells that may lie beyond a side of the box; wrap them if it is periodic."""
    for step in range(3):
        c, image_x = wrapped_index(column + (0 if along_y else step), cells.columns, periodic.x)
        r, image_y = wrapped_index(row + (step if along_y else 0), cells.rows, periodic.y)
        j = cells.head[U(r * cells.columns + c)]
        candidates[U(count)] = j
        record_image(images, count, image_x, image_y)
        count += 1 if j >= 0 else 0
    return append_sheared_rows(cells, candidates, images, count, column, row, along_y, periodic.shear)


@inline
def append_sheared_rows(cells, candidates, images, count, column, row, along_y, shear):
    """Append the discs that may come within reach through a sheared side, if the line of cells extends beyond it.

    column, row, along_y: as in `append_line`.
    """
    if shear is not None:
        if row < 1:
            count = append_sheared_row(cells, candidates, images, count, column, along_y, -1, shear)
        if row + (2 if along_y else 0) > cells.rows - 2:
            count = append_sheared_row(cells, candidates, images, count, column, along_y, 1, shear)
    return count


@noinline
def append_sheared_row(cells, candidates, images, count, column, along_y, image_y, shear):
    """Append the first discs of the cells at the opposite side that may come within a disc's reach during the epoch.

    During the epoch, the periodic image above the box moves from shear.offset[0] to shear.offset[1]. Discs can touch
    while their columns are the same or adjacent. column: as in `append_line`; the disc is in column + 1 or, if the line
    is along y, in column - 1 or column + 1. image_y: image of the row, 1 above the box and -1 below it.
    """
    across = cells.columns - 2
    first, last = (column - 1, column + 1) if along_y else (column + 1, column + 1)
    start, end = shear.offset[0] / cells.width, shear.offset[1] / cells.width
    low, high = (-end, -start) if image_y > 0 else (start, end)
    row = 1 if image_y > 0 else cells.rows - 2
    for seen in range(np.int64(math.floor(first - 1 + low)) - 1, np.int64(math.floor(last + high)) + 2):  # 0 is first
        image_x = seen // across
        j = cells.head[U(row * cells.columns + seen - image_x * across + 1)]
        candidates[U(count)] = j
        record_image(images, count, image_x, image_y)
        count += 1 if j >= 0 else 0
    return count


@inline
def is_inside(cells, column, row, columns, rows):
    """Whether a block of columns × rows cells, of which (column, row) is the first, lies entirely in the box."""
    return (column >= 1) & (row >= 1) & (column + columns < cells.columns) & (row + rows < cells.rows)


@inline
def append_line(state, count, column, row, along_y):
    """Append the first disc of each of three cells in a line to the `count` candidates; return the new number.

    The line begins at (column, row) and runs along y or along x. Its cells are in the box or in the ring around it.
    Images are not recorded.
    """
    cells = state.cells
    stride = cells.columns if along_y else 1
    cell = row * cells.columns + column
    for _ in range(3):
        j = cells.head[U(cell)]
        state.candidates[U(count)] = j
        count += 1 if j >= 0 else 0
        cell += stride
    return count


@noinline
def append_coarse_cells(state, i, disc, crossing_code, periodic):
    """Set the candidates: for a large disc all discs near it, for a small disc the large discs near it.

    A small and a large disc can touch if their coarse cells are the same or adjacent, and two large discs if they are
    at most two coarse cells apart. As in all these functions, only the first disc of each cell is appended. Returns the
    number of candidates. crossing_code: direction in which the disc has just crossed into its cell, to append only the
    discs that have come within reach; SIDE_OF_BOX to append all.
    """
    coarse, link = state.coarse, state.cells.link[U(i)]
    column, row = np.int64(link.column), np.int64(link.row)
    if disc.r > coarse.limit:
        count = append_coarse_block(state, 0, True, column, row, 1, crossing_code, periodic)
        return append_coarse_block(state, count, False, column, row, 2, crossing_code, periodic)
    if crossing_code < SIDE_OF_BOX:
        edge = (row if crossing_code >= 2 else column) - (crossing_code & 1)
        if edge % coarse.ratio != 0:
            return 0  # the disc is still in the same coarse cell
    column, row = (column - 1) // coarse.ratio + 1, (row - 1) // coarse.ratio + 1
    return append_coarse_block(state, 0, False, column, row, 1, crossing_code, periodic)


@noinline
def append_coarse_block(state, count, of_small, column, row, reach, crossing_code, periodic):
    """Append the first small or large discs of the coarse cells that are at most `reach` cells from (column, row).

    After a crossing, only the outermost cells in the direction of the crossing are searched.
    """
    low_x, high_x, low_y, high_y = column - reach, column + reach, row - reach, row + reach
    forward = reach if crossing_code & 1 else -reach
    if crossing_code < 2:
        low_x = high_x = column + forward
    elif crossing_code < SIDE_OF_BOX:
        low_y = high_y = row + forward
    for x in range(low_x, high_x + 1):
        for y in range(low_y, high_y + 1):
            count = append_coarse_cell(state, count, of_small, x, y, periodic)
    return count


@inline
def append_coarse_cell(state, count, of_small, x, y, periodic):
    """Append the first small or large discs of a coarse cell, which may lie beyond a side of the box."""
    coarse = state.coarse
    image_x = image_y = 0
    if periodic is not None:
        x, image_x = wrapped_index(x, coarse.cells.columns, periodic.x)
        y, image_y = wrapped_index(y, coarse.cells.rows, periodic.y)
    if x < 1 or y < 1 or x > coarse.cells.columns - 2 or y > coarse.cells.rows - 2:
        return count
    cells = state.cells if of_small else coarse.cells
    size = coarse.ratio if of_small else 1
    for row in range((y - 1) * size + 1, y * size + 1):
        for column in range((x - 1) * size + 1, x * size + 1):
            j = cells.head[U(row * cells.columns + column)]
            state.candidates[U(count)] = j
            if periodic is not None:
                record_image(state.images, count, image_x, image_y)
            count += 1 if j >= 0 else 0
    return count


@inline
def neighbours(state, coarse, i, disc, periodic):
    """Set the candidates to the first discs of disc i's cell and of the eight cells around it.

    Returns the number of candidates, and whether their images are recorded; if not, all images are (0, 0).
    """
    count = 0
    if coarse is not None:
        count = append_coarse_cells(state, i, disc, SIDE_OF_BOX, periodic)
        if disc.r > coarse.limit:
            return count, True
    link = state.cells.link[U(i)]
    column = np.int64(link.column) - 1
    row = np.int64(link.row) - 1
    if periodic is not None and (coarse is not None or not is_inside(state.cells, column, row, 3, 3)):
        for line in range(3):
            count = append_wrapped_line(
                state.cells, state.candidates, state.images, count, column, row + line, False, periodic
            )
        return count, True
    count = append_line(state, count, column, row, False)
    count = append_line(state, count, column, row + 1, False)
    return append_line(state, count, column, row + 2, False), False


@inline
def new_neighbours(state, coarse, i, disc, crossing_code, periodic):
    """Set the candidates to the first discs of the three cells that have come within reach of disc i.

    crossing_code: direction in which the disc crossed into its cell; see PREDICTION. Returns the same as `neighbours`.
    """
    count = 0
    if coarse is not None:
        count = append_coarse_cells(state, i, disc, crossing_code, periodic)
        if disc.r > coarse.limit:
            return count, True
    forward = 1 if crossing_code & 1 else -1
    along_y = crossing_code >= 2
    link = state.cells.link[U(i)]
    column = np.int64(link.column) + (-1 if along_y else forward)
    row = np.int64(link.row) + (forward if along_y else -1)
    columns, rows = (3, 1) if along_y else (1, 3)
    if periodic is not None and (coarse is not None or not is_inside(state.cells, column, row, columns, rows)):
        cells, images = state.cells, state.images
        return append_wrapped_line(cells, state.candidates, images, count, column, row, not along_y, periodic), True
    return append_line(state, count, column, row, not along_y), False
