"""What the event-driven method knows beyond the discs, all of it rebuilt at the start of an epoch."""

from typing import NamedTuple

import numpy as np

from idealgas._jit import aligned, inline
from idealgas.engine.event_driven.cells import Cells
from idealgas.engine.event_driven.scheduler import PREDICTION, Tree, make_tree
from idealgas.engine.event_driven.wall_cells import WallCells
from idealgas.physics.effects import Effects
from idealgas.physics.periodic import NO_IMAGES


class EventDrivenState(NamedTuple):
    """cells, tree: see there. prediction: (N,) PREDICTION, and one more for the piston.

    candidates: scratch for places of discs; images: scratch beside it, (…, 2) i4, where sides are periodic.
    walls: which segments each cell has, where there are any.
    """

    cells: Cells
    tree: Tree
    prediction: np.ndarray
    candidates: np.ndarray
    images: np.ndarray | None
    walls: WallCells | None


def make_state(n: int, cells: Cells, effects: Effects, walls: WallCells | None) -> EventDrivenState:
    """An agenda with nothing predicted."""
    leaves = n if effects.piston is None else n + 1
    room = 9 * n + 16  # in a box of one cell each disc is a candidate in nine images
    return EventDrivenState(
        cells,
        make_tree(leaves),
        aligned(leaves, PREDICTION),
        np.empty(room if effects.periodic else n + 16, np.int32),
        np.empty((room, 2), np.int32) if effects.periodic else None,
        walls,
    )


@inline
def record_image(images, k, x, y):
    """Remember in which image candidate k is met."""
    if images is not None:
        images[np.uintp(k), 0] = x
        images[np.uintp(k), 1] = y


@inline
def copy_image(images, to, k):
    """A candidate behind candidate k is met in the same image."""
    if images is not None:
        images[np.uintp(to), 0] = images[np.uintp(k), 0]
        images[np.uintp(to), 1] = images[np.uintp(k), 1]


@inline
def image_of(images, k):
    """In which image candidate k is met."""
    if images is not None:
        return np.int64(images[np.uintp(k), 0]), np.int64(images[np.uintp(k), 1])
    return NO_IMAGES
