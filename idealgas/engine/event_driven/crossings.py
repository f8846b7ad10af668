"""When a disc leaves its cell or meets a side of the box, and the step into the next cell."""

import numpy as np

from idealgas._jit import inline
from idealgas.engine.event_driven.cells import cell_index, enter, leave
from idealgas.engine.event_driven.scheduler import SIDE_OF_BOX
from idealgas.physics.box_side import arrival_delay, centre_range
from idealgas.physics.constants import NEVER
from idealgas.physics.fall import landing_delay
from idealgas.physics.motion import acceleration_along
from idealgas.physics.periodic import turns_along
from idealgas.physics.piston import is_piston_side

U = np.uintp


@inline
def straight_exit(disc, along_y, cell, size, cells_across, length, turns, joined):
    """Time, whether forward, and whether at a side of the box, along one axis in straight flight."""
    position, velocity = (disc.y, disc.vy) if along_y else (disc.x, disc.vx)
    forward = velocity > 0.0
    edge = cell if forward else cell - 1
    target = edge * size
    at_side = (edge == 0) | (edge == cells_across - 2)
    low, high = centre_range(length, disc.r)
    if joined:
        target += turns * length
        at_side = False
    else:
        target = min(max(target, low), high)
    return disc.t + arrival_delay(position, velocity, target), forward, at_side


@inline
def accelerated_exit(disc, along_y, cell, size, cells_across, length, turns, joined, now, pull):
    """The same on a parabola. Cell edges are seen from now, when the disc is in its cell; sides from its record."""
    position, velocity = (disc.y, disc.vy) if along_y else (disc.x, disc.vx)
    dt = max(now - disc.t, 0.0)
    here = position + velocity * dt + 0.5 * pull * dt * dt - turns * length
    speed = velocity + pull * dt
    first = (cell == 1) & (not joined)
    last = (cell == cells_across - 2) & (not joined)
    low, high = centre_range(length, disc.r)
    if first:
        down = disc.t + landing_delay(position - low, velocity, pull)
    else:
        down = max(now, disc.t) + landing_delay(here - (cell - 1) * size, speed, pull)
    if last:
        up = disc.t + landing_delay(high - position, -velocity, -pull)
    else:
        up = max(now, disc.t) + landing_delay(cell * size - here, -speed, -pull)
    return (up, True, last) if up < down else (down, False, first)


@inline
def exit_along(disc, along_y, cell, size, cells_across, length, turns, joined, now, gravity):
    """The one or the other."""
    if gravity is not None:
        pull = acceleration_along(gravity, along_y)
        return accelerated_exit(disc, along_y, cell, size, cells_across, length, turns, joined, now, pull)
    return straight_exit(disc, along_y, cell, size, cells_across, length, turns, joined)


@inline
def axis_exit(disc, along_y, cells, own, now, effects):
    """Time, whether forward, and whether at a side of the box, along one axis."""
    cell = np.int64(disc.row) if along_y else np.int64(disc.column)
    size = cells.height if along_y else cells.width
    across = cells.rows if along_y else cells.columns
    length = cells.Ly if along_y else cells.Lx
    turns, joined = turns_along(effects.periodic, own, along_y)
    time, forward, at_side = exit_along(disc, along_y, cell, size, across, length, turns, joined, now, effects.gravity)
    if at_side and is_piston_side((2 if along_y else 0) + (1 if forward else 0), effects.piston):
        time = NEVER
    return time, forward, at_side


@inline
def predict_exit(record, ids, agenda, i, now, effects):
    """When and where disc i leaves its cell or meets a side of the box."""
    disc = record[U(i)]
    own = ids[U(i)]
    x_time, right, x_side = axis_exit(disc, False, agenda.cells, own, now, effects)
    y_time, up, y_side = axis_exit(disc, True, agenda.cells, own, now, effects)
    along_y = y_time < x_time
    forward = up if along_y else right
    prediction = agenda.prediction[U(i)]
    prediction.exit = y_time if along_y else x_time
    side = (2 if along_y else 0) + (1 if forward else 0)
    prediction.exit_code = side + (SIDE_OF_BOX if (y_side if along_y else x_side) else 0)


@inline
def go_round(disc, own, cells, along_y, periodic):
    """Bring a disc that stepped beyond joined sides back into the cells, and count the turn."""
    if periodic is not None:
        if along_y and periodic.y:
            turn = 1 if disc.row > cells.rows - 2 else (-1 if disc.row < 1 else 0)
            disc.row -= turn * (cells.rows - 2)
            periodic.turns[U(own), 1] += np.int32(turn)
        elif not along_y and periodic.x:
            turn = 1 if disc.column > cells.columns - 2 else (-1 if disc.column < 1 else 0)
            disc.column -= turn * (cells.columns - 2)
            periodic.turns[U(own), 0] += np.int32(turn)


@inline
def change_cell(record, ids, agenda, i, exit_code, periodic):
    """Move a disc from its cell's chain to the next cell's."""
    disc = record[U(i)]
    leave(agenda.cells, i, cell_index(agenda.cells, disc))
    forward = 1 if exit_code & 1 else -1
    if exit_code >= 2:
        disc.row += forward
    else:
        disc.column += forward
    go_round(disc, ids[U(i)], agenda.cells, exit_code >= 2, periodic)
    enter(agenda.cells, i, cell_index(agenda.cells, disc))
