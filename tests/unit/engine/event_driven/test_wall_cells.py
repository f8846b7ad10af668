"""The wall segments of each cell: all that a disc in the cell may touch, and few others."""

import numpy as np
import pytest

from idealgas.engine.event_driven.cells import make_cells
from idealgas.engine.event_driven.wall_cells import make_wall_cells
from idealgas.physics.wall import SEGMENT

BOX, RADIUS = (8.0, 6.0), 0.3


def segments(ends):
    """Segments of the table from start and end points (K, 4), length."""
    made = np.zeros(len(ends), SEGMENT).view(np.recarray)
    across = ends[:, 2:] - ends[:, :2]
    made.x, made.y = ends[:, 0], ends[:, 1]
    made.length = np.hypot(*across.T)
    made.tx, made.ty = (across / made.length[:, None]).T
    made.active = True
    return made


def distance(points, wall):
    """From points (..., 2) to a segment, length."""
    away = points - (wall.x, wall.y)
    along = np.clip(away @ (wall.tx, wall.ty), 0.0, wall.length)
    return np.hypot(*np.moveaxis(away - along[..., None] * (wall.tx, wall.ty), -1, 0))


@pytest.mark.parametrize("filling", [0.2, 2.0])
def test_cells_of_segments(filling):
    """A grid of points in each cell tells how near each segment comes: all that come within the radius are entered, and
    none that stays out of the corners of a cell that is wider by the radius on every side.
    """
    draw = np.random.default_rng(1)
    ends = draw.uniform(0.0, 1.0, (40, 4)) * (*BOX, *BOX)
    ends[:20, 2:] = np.clip(ends[:20, :2] + draw.normal(size=(20, 2)) * 0.3, 0.0, BOX)  # short ones
    ends[20:25, 2] = ends[20:25, 0]  # upright ones
    made = segments(ends)
    cells = make_cells(100, BOX, RADIUS, filling)
    walls = make_wall_cells(made, None, None, cells, RADIUS)
    grid = np.stack(np.meshgrid(*(np.linspace(0.0, 1.0, 30),) * 2), axis=-1)
    step = np.hypot(cells.width, cells.height) / 58
    for row in range(1, cells.rows - 1):
        for column in range(1, cells.columns - 1):
            cell = row * cells.columns + column
            entered = set(walls.item[walls.start[cell] : walls.start[cell + 1]])
            points = (np.array([column, row]) - 1 + grid) * (cells.width, cells.height)
            nearest = np.array([distance(points, wall).min() for wall in made])
            assert set(np.flatnonzero(nearest < RADIUS)) <= entered
            assert entered <= set(np.flatnonzero(nearest < np.sqrt(2) * RADIUS + step))
