"""Prefetching the memory of discs that will soon have events, for a gas that does not fit into the caches.

When a disc becomes the first in its branch of the schedule, it will soon have an event. Two levels below the root there
are 8 to 64 branches, and the event is about ten events away. (Directly below the root there may be only two branches,
so that the first disc of a branch often has the very next event.) The memory is fetched in three steps, one event apart
because each step needs the data of the previous step: first the disc's record, prediction and nodes of the schedule;
then the cells around the disc, and its partner; then the discs in the cells that its event will search.
"""

import numpy as np

from idealgas.engine.event_driven.prediction import SIDE_OF_BOX
from idealgas.jit import aligned, inline, prefetch

FROM = 6_000
"""Smallest number of discs for which prefetching is faster."""

NEAR = 32_768
"""Largest number of discs for which the branches directly below the root suffice, if there are at least three."""

U = np.uintp


def make_pipeline(n: int, levels: int) -> np.ndarray | None:
    """Make the pipeline, (3,) i8: indices of two discs whose memory is being fetched, and the level of the branches.

    Returns None for a gas of few discs. levels: number of levels of the schedule, of which the last is the root.
    """
    if n < FROM:
        return None
    below_root = levels - 2
    enough = n <= NEAR and n > 2 * 8**below_root
    pipeline: np.ndarray = aligned(3, np.dtype("i8"))
    pipeline[2] = below_root if enough else max(below_root - 1, 0)
    return pipeline


@inline
def first_of_part(tree, level, i):
    """Index of the disc with the next event in disc i's branch of the tree; level: level of the branch's node."""
    return np.int64(tree.winner[U(tree.start[U(level)] + (i >> (3 * level)))])


@inline
def fetch_disc(tree, record, state, i):
    """Fetch disc i's record, prediction, link and nodes in the schedule."""
    prefetch(record, U(i))
    prefetch(state.prediction, U(i))
    prefetch(state.cells.link, U(i))
    parent = U(tree.start[U(1)] + (i >> 3))
    prefetch(tree.key, U(i))
    prefetch(tree.winner, U(i))
    prefetch(tree.key, parent)
    prefetch(tree.winner, parent)


@inline
def cell_around(cells, i):
    """Index of disc i's cell; it is valid even while another thread moves the disc across a periodic side."""
    link = cells.link[U(i)]
    row = min(max(np.int64(link.row), np.int64(1)), cells.rows - 2)
    return row * cells.columns + min(max(np.int64(link.column), np.int64(1)), cells.columns - 2)


@inline
def fetch_cells(cells, i):
    """Fetch the cells around disc i, including those that come within its reach if it crosses into another cell."""
    cell = cell_around(cells, i)
    for row in range(-2, 3):
        prefetch(cells.head, U(cell + row * cells.columns))


@inline
def fetch_first_of_three(cells, record, cell, stride):
    """Fetch the first discs of three cells in a row or column."""
    last = cells.head.shape[0] - 1
    for step in range(3):
        j = U(max(cells.head[U(min(max(cell + step * stride, 0), last))], 0))
        prefetch(record, j)
        prefetch(cells.link, j)


@inline
def fetch_block(cells, record, cell):
    """Fetch the first discs of a cell and of the eight around it."""
    for row in range(-1, 2):
        fetch_first_of_three(cells, record, cell + row * cells.columns - 1, 1)


@inline
def fetch_candidates(cells, record, i, prediction):
    """Fetch the first discs of the cells that disc i's next event will search."""
    cell = cell_around(cells, i)
    code = prediction.crossing_code
    if prediction.crossing < prediction.contact and code < SIDE_OF_BOX:
        ahead = 2 if code & 1 else -2  # cells that come within reach
        if code >= 2:
            fetch_first_of_three(cells, record, cell + ahead * cells.columns - 1, 1)
        else:
            fetch_first_of_three(cells, record, cell + ahead - cells.columns, cells.columns)
    else:
        fetch_block(cells, record, cell)
        if prediction.partner >= 0:
            fetch_block(cells, record, cell_around(cells, prediction.partner))


@inline
def prefetch_next(pipeline, record, state, i, noninteracting):
    """Fetch memory for the new first disc of the branch from which disc i was removed, and for the two discs before."""
    if pipeline is not None:
        third, second = pipeline[0], pipeline[1]
        first = min(first_of_part(state.tree, pipeline[2], i), record.shape[0] - 1)  # it may be a piston's leaf
        pipeline[0], pipeline[1] = second, first
        fetch_disc(state.tree, record, state, first)
        if noninteracting is None:
            fetch_cells(state.cells, second)
            fetch_disc(state.tree, record, state, max(np.int64(state.prediction[U(second)].partner), np.int64(0)))
            fetch_candidates(state.cells, record, third, state.prediction[U(third)])
