"""The time at which a disc crosses into the next cell, meets a side of the box or the heat bath; and cell crossings."""

import numpy as np

from idealgas.engine.event_driven.cells import cell_index, enter, find_cell, is_in_ring, leave, own_cells
from idealgas.engine.event_driven.prediction import SIDE_OF_BOX, THERMOSTAT
from idealgas.jit import inline
from idealgas.physics.disc_wall import arrival_delay
from idealgas.physics.gravity import acceleration_along
from idealgas.physics.motion import NEVER, position_after, time_after, time_to_plane, velocity_after
from idealgas.physics.periodic import boundary_crossings_along, is_periodic
from idealgas.physics.piston import is_piston_side
from idealgas.physics.shear import crossing_time
from idealgas.physics.vibration import is_vibrating, misses_side_until, vibrating_contact

U = np.uintp


@inline
def straight_crossing(disc, along_y, cell, size, cells_across, length, boundary_crossings, is_periodic):
    """Next cell crossing or side contact along one axis in straight flight.

    Returns its local time, whether it is in the positive direction, and whether it is a contact with a side of the box.
    cell: column or row. size: of a cell, length. cells_across: columns or rows. length: of the box.
    """
    position, velocity = (disc.y, disc.vy) if along_y else (disc.x, disc.vx)
    forward = velocity > 0.0
    edge = cell if forward else cell - 1
    target = edge * size
    at_side = (edge == 0) | (edge == cells_across - 2)
    low, high = disc.r, length - disc.r
    if is_periodic:
        target += boundary_crossings * length
        at_side = False
    else:
        target = min(max(target, low), high)
    return disc.t + arrival_delay(position, velocity, target), forward, at_side


@inline
def accelerated_crossing(disc, along_y, cell, size, cells_across, length, boundary_crossings, is_periodic, now, pull):
    """Next cell crossing or side contact along one axis under gravity.

    Arguments and results are those of `straight_crossing`; pull: acceleration along the axis, length/time². Cell
    crossings are computed from the disc's state at the local time `now`, when it is in its cell; side contacts from its
    record.
    """
    position, velocity = (disc.y, disc.vy) if along_y else (disc.x, disc.vx)
    dt = max(now - disc.t, 0.0)
    here = position_after(position, velocity, pull, dt) - boundary_crossings * length
    speed = velocity_after(velocity, pull, dt)
    first = (cell == 1) & (not is_periodic)
    last = (cell == cells_across - 2) & (not is_periodic)
    low, high = disc.r, length - disc.r
    if first:
        down = disc.t + time_to_plane(position - low, velocity, pull)
    else:
        down = time_after(max(now, disc.t), time_to_plane(here - (cell - 1) * size, speed, pull))
    if last:
        up = disc.t + time_to_plane(high - position, -velocity, -pull)
    else:
        up = time_after(max(now, disc.t), time_to_plane(cell * size - here, -speed, -pull))
    return (up, True, last) if up < down else (down, False, first)


@inline
def crossing_along(disc, along_y, cell, size, cells_across, length, boundary_crossings, is_periodic, now, gravity):
    """Next cell crossing or side contact along one axis, with or without gravity; see `straight_crossing`."""
    if gravity is not None:
        pull = acceleration_along(gravity, along_y)
        if pull != 0.0:  # else the path along this axis is straight, and both laws give the same bits
            return accelerated_crossing(
                disc, along_y, cell, size, cells_across, length, boundary_crossings, is_periodic, now, pull
            )
    return straight_crossing(disc, along_y, cell, size, cells_across, length, boundary_crossings, is_periodic)


@inline
def axis_crossing(disc, link, along_y, cells, now, effects):
    """Next cell crossing or side contact of a disc along one axis: local time, whether forward, whether at a side.

    The time is NEVER at the side of a piston, where contacts belong to it, and at a vibrating side.
    """
    cell = np.int64(link.row) if along_y else np.int64(link.column)
    size = cells.height if along_y else cells.width
    across = cells.rows if along_y else cells.columns
    length = cells.Ly if along_y else cells.Lx
    boundary_crossings, is_periodic = boundary_crossings_along(effects.periodic, disc, along_y)
    time, forward, at_side = crossing_along(
        disc, along_y, cell, size, across, length, boundary_crossings, is_periodic, now, effects.gravity
    )
    side = (2 if along_y else 0) + (1 if forward else 0)
    time = crossing_if_sheared(time, disc, at_side, side, length, effects.shear)
    if at_side and (is_piston_side(side, effects.piston) or is_vibrating(effects.vibration, side)):
        time = NEVER
    return time, forward, at_side


@inline
def crossing_if_sheared(time, disc, at_side, side, length, shear):
    """Local time at which a disc's centre crosses a side of the box if it is sheared; else the given time."""
    if shear is not None:
        return crossing_time(disc, side, length) if at_side else time
    return time


@inline
def predict_crossing(record, ids, state, i, now, effects):
    """Store in disc i's prediction the time and kind of its next cell crossing, side or thermostat collision."""
    disc = record[U(i)]
    own = ids[U(i)]
    cells = own_cells(state.cells, state.coarse, disc)
    x_time, right, x_side = axis_crossing(disc, cells.link[U(i)], False, cells, now, effects)
    y_time, up, y_side = axis_crossing(disc, cells.link[U(i)], True, cells, now, effects)
    along_y = y_time < x_time  # either is as likely: to branch on it would take 7 % of all time
    x_code = (1 if right else 0) + (SIDE_OF_BOX if x_side else 0)
    y_code = (3 if up else 2) + (SIDE_OF_BOX if y_side else 0)
    prediction = state.prediction[U(i)]
    prediction.crossing = min(x_time, y_time)
    prediction.crossing_code = y_code if along_y else x_code
    keep_vibrating_contact_if_earlier(prediction, disc, own, state.cells, effects.vibration, effects)
    keep_thermostat_collision_if_earlier(prediction, own, effects.thermostat)


@inline
def keep_vibrating_contact_if_earlier(prediction, disc, own, cells, vibration, effects):
    """Store a disc's next contact with a vibrating side in its prediction if it precedes its crossing."""
    if vibration is not None:
        for side in range(4):
            if is_vibrating(vibration, side) and not is_periodic(effects.periodic, side >= 2):
                length = cells.Ly if side >= 2 else cells.Lx
                if misses_side_until(disc, vibration[U(side)], side, length, effects.gravity, prediction.crossing):
                    continue
                time = vibrating_contact(disc, vibration[U(side)], side, length, effects.gravity)
                code = SIDE_OF_BOX + side
                if (time < prediction.crossing) | ((time == prediction.crossing) & (code < prediction.crossing_code)):
                    prediction.crossing = time
                    prediction.crossing_code = code


@inline
def keep_thermostat_collision_if_earlier(prediction, own, thermostat):
    """Store a disc's next thermostat collision in its prediction if it precedes its crossing."""
    if thermostat is not None:
        time = thermostat.time[U(own)]
        if time < prediction.crossing:
            prediction.crossing = time
            prediction.crossing_code = THERMOSTAT


@inline
def is_thermostat_collision(crossing_code, thermostat):
    """Whether a disc's crossing is a thermostat collision."""
    if thermostat is not None:
        return crossing_code == THERMOSTAT
    return False


@inline
def wrap_cell(disc, link, cells, along_y, periodic):
    """Wrap the column or row of a disc that crossed a periodic side, and count the boundary crossing."""
    if periodic is not None and is_in_ring(cells, link):
        if along_y:
            cross_boundary = 1 if link.row > cells.rows - 2 else -1
            link.row -= cross_boundary * (cells.rows - 2)
            disc.crossed_y += np.int16(cross_boundary)
        else:
            cross_boundary = 1 if link.column > cells.columns - 2 else -1
            link.column -= cross_boundary * (cells.columns - 2)
            disc.crossed_x += np.int16(cross_boundary)


@inline
def move_to_cell(record, state, i, shear):
    """Move disc i to the list of the cell of its position after an event at a sheared side."""
    if shear is not None:
        leave(state.cells, i, cell_index(state.cells, i))
        find_cell(state.cells, i, record[U(i)])
        enter(state.cells, i, cell_index(state.cells, i))


@inline
def cross_cell(record, state, i, crossing_code, periodic):
    """Move disc i from its cell's list to that of the next cell; crossing_code: direction, see PREDICTION."""
    disc = record[U(i)]
    cells = own_cells(state.cells, state.coarse, disc)
    link = cells.link[U(i)]
    leave(cells, i, cell_index(cells, i))
    forward = 1 if crossing_code & 1 else -1
    upwards = forward if crossing_code >= 2 else 0
    link.row += upwards
    link.column += forward - upwards
    wrap_cell(disc, link, cells, crossing_code >= 2, periodic)
    enter(cells, i, cell_index(cells, i))
