"""Prediction of a disc's next cell crossing or contact with a side or the heat bath, and moves between cells."""

import numpy as np

from idealgas.engine.event_driven.cells import enter, find_cell, leave, own_cells
from idealgas.engine.event_driven.prediction import SIDE_OF_BOX, THERMOSTAT
from idealgas.jit import inline
from idealgas.physics.disc_wall import arrival_delay
from idealgas.physics.gravity import acceleration_along
from idealgas.physics.motion import NEVER, position_after, time_after, time_to_plane, velocity_after
from idealgas.physics.periodic import is_periodic
from idealgas.physics.piston import is_piston_side
from idealgas.physics.shear import crossing_time
from idealgas.physics.vibration import is_vibrating, misses_side_until, vibrating_contact

U = np.uintp


@inline
def straight_crossing(disc, along_y, axis):
    """Find the next cell crossing or side contact along one axis in straight flight.

    Returns its local time, whether it is in the positive direction, and whether it is a contact with a side of the box.
    axis: the column or row of the disc; the size of a cell, length; the number of columns or rows; the length of the
    box; the number of boundary crossings of the disc; whether the axis is periodic.
    """
    cell, size, cells_across, length, boundary_crossings, is_periodic = axis
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
def accelerated_crossing(disc, along_y, axis, now, pull):
    """Find the next cell crossing or side contact along one axis under gravity.

    Arguments and results are as in `straight_crossing`; pull: acceleration along the axis, length/time². Cell crossings
    are computed from the disc's state at local time `now`, when the disc is in its cell, and side contacts from its
    stored state.
    """
    cell, size, cells_across, length, boundary_crossings, is_periodic = axis
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
def axis_crossing(disc, link, along_y, cells, now, gravity, periodic, effects):
    """Find the next cell crossing or side contact of a disc along one axis; the results are as in `straight_crossing`.

    The time is NEVER at a side with a piston and at a vibrating side, whose contacts are predicted separately. A disc
    meets a sheared side when its centre reaches the side.
    """
    cell = np.int64(link.row) if along_y else np.int64(link.column)
    size = cells.height if along_y else cells.width
    across = cells.rows if along_y else cells.columns
    length = cells.Ly if along_y else cells.Lx
    crossings, is_periodic = np.int16(0), False
    if periodic is not None:
        crossings = disc.crossed_y if along_y else disc.crossed_x
        is_periodic = periodic.y if along_y else periodic.x
    axis = cell, size, across, length, crossings, is_periodic
    if gravity is not None and acceleration_along(gravity, along_y) != 0.0:
        time, forward, at_side = accelerated_crossing(disc, along_y, axis, now, acceleration_along(gravity, along_y))
    else:  # without acceleration along this axis, both functions would give the same bits
        time, forward, at_side = straight_crossing(disc, along_y, axis)
    if at_side:
        side = (2 if along_y else 0) + (1 if forward else 0)
        time = crossing_time(disc, side, length, effects.shear, time)
        if is_piston_side(side, effects.piston) or is_vibrating(effects.vibration, side):
            time = NEVER
    return time, forward, at_side


@inline
def predict_crossing(record, ids, state, i, now, thermostat, vibration, effects):
    """Store the time and kind of disc i's next cell crossing, side contact or thermostat collision."""
    disc = record[U(i)]
    cells = own_cells(state.cells, state.coarse, disc)
    link = cells.link[U(i)]
    x_time, right, x_side = axis_crossing(disc, link, False, cells, now, effects.gravity, effects.periodic, effects)
    y_time, up, y_side = axis_crossing(disc, link, True, cells, now, effects.gravity, effects.periodic, effects)
    along_y = y_time < x_time  # both axes are equally likely, so a branch would take 7 % of the total time
    x_code = (1 if right else 0) + (SIDE_OF_BOX if x_side else 0)
    y_code = (3 if up else 2) + (SIDE_OF_BOX if y_side else 0)
    prediction = state.prediction[U(i)]
    prediction.crossing = min(x_time, y_time)
    prediction.crossing_code = y_code if along_y else x_code
    if vibration is not None:
        keep_vibrating_contact_if_earlier(prediction, disc, state.cells, vibration, effects)
    if thermostat is not None and thermostat.time[U(ids[U(i)])] < prediction.crossing:
        prediction.crossing = thermostat.time[U(ids[U(i)])]
        prediction.crossing_code = THERMOSTAT


@inline
def keep_vibrating_contact_if_earlier(prediction, disc, cells, vibration, effects):
    """Store a disc's next contact with a vibrating side in its prediction if this contact precedes the crossing."""
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
def move_to_cell(record, state, i, shear):
    """Move disc i, after an event at a sheared side, to the list of the cell in which its centre is now."""
    if shear is not None:
        leave(state.cells, i)
        find_cell(state.cells, i, record[U(i)])
        enter(state.cells, i)


@inline
def cross_cell(record, state, i, crossing_code, periodic, noninteracting):
    """Move disc i from its cell's list to the list of the next cell; crossing_code: direction (see PREDICTION).

    A disc that crosses a periodic side enters the cell at the opposite side, and the crossing is counted.
    """
    disc = record[U(i)]
    cells = own_cells(state.cells, state.coarse, disc)
    link = cells.link[U(i)]
    if noninteracting is None:  # otherwise the lists are not used
        leave(cells, i)
    forward = 1 if crossing_code & 1 else -1
    upwards = forward if crossing_code >= 2 else 0
    link.row += upwards
    link.column += forward - upwards
    if periodic is not None:
        if (link.row < 1) | (link.row > cells.rows - 2):
            link.row -= upwards * (cells.rows - 2)
            disc.crossed_y += np.int16(upwards)
        if (link.column < 1) | (link.column > cells.columns - 2):
            link.column -= forward * (cells.columns - 2)
            disc.crossed_x += np.int16(forward)
    if noninteracting is None:
        enter(cells, i)
