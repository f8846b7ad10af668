"""State of the event-driven method apart from the discs themselves; it is rebuilt at the start of each epoch."""

from typing import NamedTuple

import numpy as np

from idealgas.effects.bundle import Effects
from idealgas.engine.event_driven.cells import Cells, CoarseCells
from idealgas.engine.event_driven.prediction import PREDICTION
from idealgas.engine.event_driven.prefetch import make_pipeline
from idealgas.engine.event_driven.scheduler import Tree, make_tree
from idealgas.engine.event_driven.wall_cells import WallCells
from idealgas.jit import aligned, inline

IMAGE = np.dtype([("x", "i4"), ("y", "i4")], align=True)  # numbers of box lengths along x and y


class EventDrivenState(NamedTuple):
    """Cells, predictions and schedule of the event-driven method.

    Attributes:
        cells: cells of the neighbour search.
        coarse: coarse cells of the largest discs; None if all discs are in the same cells.
        tree: schedule of the discs' next events.
        prediction: (N,) PREDICTION by index, next contact and crossing of each disc. With K pistons the shape is
            (N + K,), and the last K predictions are those of the pistons.
        candidates: i4 scratch memory for indices of discs that may be in contact.
        images: IMAGE scratch memory for the images of the candidates; None without periodic sides.
        walls: wall segments of each cell; None without segments.
        coarse_walls: wall segments of each coarse cell; None without segments or without coarse cells.
        pipeline: (3,) i8, see `make_pipeline`; None for a gas that fits into the caches.
        unpredicted: (1,) bool, whether an epoch has begun whose events have not been predicted yet.
    """

    cells: Cells
    coarse: CoarseCells | None
    tree: Tree
    prediction: np.ndarray
    candidates: np.ndarray
    images: np.ndarray | None
    walls: WallCells | None
    coarse_walls: WallCells | None
    pipeline: np.ndarray | None
    unpredicted: np.ndarray


def make_state(n: int, cells: Cells, coarse: CoarseCells | None, effects: Effects) -> EventDrivenState:
    """Make the event-driven state of n discs, without predictions and walls."""
    leaves = n if effects.piston is None else n + len(effects.piston)
    most = 9 if effects.shear is None else 25  # most images of one disc among the candidates, in a box of one cell
    room = most * n + 16
    tree = make_tree(leaves)
    return EventDrivenState(
        cells,
        coarse,
        tree,
        aligned(leaves, PREDICTION),
        aligned(room if effects.periodic else n + 16, np.dtype("i4")),
        aligned(room, IMAGE) if effects.periodic else None,
        None,
        None,
        make_pipeline(n, len(tree.start)),
        np.ones(1, np.bool_),
    )


@inline
def record_image(images, k, x, y):
    """Store the image (x, y) of candidate k."""
    images[np.uintp(k)].x = x
    images[np.uintp(k)].y = y
