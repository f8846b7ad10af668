"""The brute-force method: before every event, all pairs, walls and images are searched for the next event, O(N²).

It is the reference for the event-driven method: it uses the same laws and the same rule for simultaneous events, but
stores no predictions.
"""

import numpy as np

from idealgas.columns import BATH, FIRST_SEGMENT, EventBatch
from idealgas.engine.event_writer import (
    DISC,
    ESCAPED,
    PISTON,
    THERMOSTAT,
    WALL,
    batch_capacity,
    write_hit,
    write_pair,
)
from idealgas.engine.method import Limits, Method
from idealgas.engine.records import add_to_counters, check_clock
from idealgas.engine.resolve import (
    resolve_pair,
    resolve_piston,
    resolve_segment,
    resolve_side,
    resolve_stop,
    resolve_thermostat_collision,
)
from idealgas.jit import inline, njit
from idealgas.physics.absorbing import has_left, leave_gas
from idealgas.physics.arc import wall_contact
from idealgas.physics.disc_disc import contact_time
from idealgas.physics.disc_wall import arrival_delay
from idealgas.physics.gravity import acceleration_along
from idealgas.physics.motion import NEVER, position_after, time_after, time_to_plane, velocity_after
from idealgas.physics.periodic import images_between, images_to_wall, is_periodic
from idealgas.physics.permeable import passage_of
from idealgas.physics.piston import is_piston_side, piston_contact, stop_contact
from idealgas.physics.shear import crossing_time
from idealgas.physics.vibration import contact_with_side

SEGMENT, STOP, BOUNDARY_CROSSING = range(16, 19)  # in addition to the kinds of events
INNER = -1  # stands for inner pistons in place of the number of a side


@inline
def wall_event(record, i, effects, length_x, length_y, best):
    """The earlier of the event `best` and disc i's next contact with a side, a piston or a wall segment.

    best: event in the form of `next_event`. length_x, length_y: size of the box, length.
    """
    disc = record[i]
    for side in range(4):
        along_y = side >= 2
        if is_piston_side(side, effects.piston):
            best = piston_event(disc, i, side, effects.piston, effects.gravity, best)
        elif not is_periodic(effects.periodic, along_y):
            time = side_time(disc, side, length_y if along_y else length_x, effects.shear, effects)
            if time < best[0]:
                best = (time, WALL, i, side, 0, 0)
    best = segment_event(disc, i, effects.segments, effects, best)
    return piston_event(disc, i, INNER, effects.piston, effects.gravity, best)


@inline
def side_time(disc, side, length, shear, effects):
    """Local time at which a disc touches a side of the box, or crosses a sheared side; NEVER if it does not."""
    if shear is not None:
        return crossing_time(disc, side, length, shear, NEVER)
    return contact_with_side(disc, side, length, effects.gravity, effects.vibration)


@inline
def piston_event(disc, i, side, piston, gravity, best):
    """The earlier of the event `best` and disc i's next contact with the piston at a side, or with INNER pistons."""
    if piston is not None:
        for k in range(piston.shape[0]):
            if piston[k].outward == 0.0 if side == INNER else piston[k].wall == side:
                time = piston_contact(disc, piston[k], gravity)
                if time < best[0]:
                    best = (time, PISTON, i, k, 0, 0)
    return best


@inline
def segment_event(disc, i, segments, effects, best):
    """The earlier of the event `best` and disc i's next contact with a wall segment, in all images."""
    if segments is not None:
        for k in range(segments.shape[0]):
            if segments[k].active:
                passage = passage_of(effects.permeable, i, k)
                for image_x in range(*image_range(effects.periodic, False)):
                    for image_y in range(*image_range(effects.periodic, True)):
                        images = images_to_wall(effects.periodic, disc, (image_x, image_y))
                        time = wall_contact(disc, i, k, effects.arcs, passage, images, effects)
                        if time < best[0]:
                            best = (time, SEGMENT, i, k, image_x, image_y)
    return best


@inline
def thermostat_event(i, thermostat, best):
    """The earlier of the event `best` and disc i's next thermostat collision."""
    if thermostat is not None:
        time = thermostat.time[i]
        if time < best[0]:
            best = (time, THERMOSTAT, i, 0, 0, 0)
    return best


@inline
def pair_event(record, i, j, effects, best):
    """The earlier of the event `best` and the next collision of discs i and j, in all images."""
    for image_x in range(*sheared_range(effects.shear, 3, image_range(effects.periodic, False))):
        for image_y in range(*sheared_range(effects.shear, 1, image_range(effects.periodic, True))):
            images = images_between(effects.periodic, record[i], record[j], (image_x, image_y))
            time = contact_time(record[i], record[j], i, j, images, effects.gravity, effects.periodic, effects)
            if time < best[0]:
                best = (time, DISC, i, j, image_x, image_y)
    return best


@inline
def pair_events(record, i, noninteracting, effects, best):
    """The earlier of the event `best` and disc i's next collision with a disc of a larger id."""
    if noninteracting is None:
        for j in range(i + 1, record.shape[0]):
            if not has_left(record[j], effects.absorbing):
                best = pair_event(record, i, j, effects, best)
    return best


@inline
def image_range(periodic, along_y):
    """Range of the neighbouring images along an axis: -1 to 1 if the axis is periodic, otherwise only 0."""
    return (-1, 2) if is_periodic(periodic, along_y) else (0, 1)


@inline
def sheared_range(shear, most, unsheared):
    """Range of the images along an axis: -most to most if sides are sheared, otherwise `unsheared`.

    At the start of an epoch the image above is shifted by up to one box length; during the epoch it moves by up to one
    box length; and discs are up to one box length apart.
    """
    if shear is not None:
        return (-most, most + 1)
    return unsheared


@inline
def boundary_crossing_along(disc, along_y, crossings, length, gravity, now):
    """Find a disc's next crossing of a periodic side along an axis.

    Returns its local time, and whether the crossing is in the positive direction. Under gravity the time is computed
    from the disc's state at local time `now`, up to which crossings are counted.
    """
    position, velocity = (disc.y, disc.vy) if along_y else (disc.x, disc.vx)
    if gravity is not None:
        pull = acceleration_along(gravity, along_y)
        if pull != 0.0:
            dt = max(now - disc.t, 0.0)
            here = position_after(position, velocity, pull, dt) - crossings * length
            speed = velocity_after(velocity, pull, dt)
            down, up = time_to_plane(here, speed, pull), time_to_plane(length - here, -speed, -pull)
            return time_after(max(now, disc.t), min(down, up)), up < down
    forward = velocity > 0.0
    return disc.t + arrival_delay(position, velocity, (crossings + (1 if forward else 0)) * length), forward


@inline
def boundary_crossing_event(record, i, periodic, gravity, now, best):
    """The earlier of the event `best` and disc i's next crossing of a periodic side.

    A crossing does not change a position or a velocity, but only the images in which contacts of the disc are searched.
    """
    if periodic is not None:
        for axis in range(2):
            if is_periodic(periodic, axis == 1):
                crossings = record[i].crossed_y if axis == 1 else record[i].crossed_x
                length = periodic.Ly if axis == 1 else periodic.Lx
                time, forward = boundary_crossing_along(record[i], axis == 1, crossings, length, gravity, now)
                if time < best[0]:
                    best = (time, BOUNDARY_CROSSING, i, axis, 1 if forward else -1, 0)
    return best


@inline
def stop_event(piston, best):
    """The earlier of the event `best` and a piston's arrival at a side; if they are simultaneous, the arrival."""
    if piston is not None:
        for k in range(piston.shape[0]):
            time = stop_contact(piston[k])
            if time < best[0] or (time == best[0] and time < NEVER and best[1] != STOP):
                best = (time, STOP, k, 0, 0, 0)
    return best


@inline
def next_event(record, box, effects, now):
    """Return the earliest event as (local time, kind, disc, partner, image_x, image_y); records are in order of id.

    now: local time up to which all events have happened. For a BOUNDARY_CROSSING the partner is the axis, and image_x
    the direction. Events are searched in the order of simultaneous events, by the smaller id, then walls, then the
    heat bath, then the other id, so that the first of them is returned.
    """
    best = (NEVER, DISC, 0, 0, 0, 0)
    for i in range(record.shape[0]):
        if has_left(record[i], effects.absorbing):
            continue
        best = wall_event(record, i, effects, box[0], box[1], best)
        best = thermostat_event(i, effects.thermostat, best)
        best = pair_events(record, i, effects.noninteracting, effects, best)
        best = boundary_crossing_event(record, i, effects.periodic, effects.gravity, now, best)
    return stop_event(effects.piston, best)


@inline
def cross_boundary(periodic, disc, axis, forward):
    """Count a disc's crossing of a periodic side along an axis; forward: 1 or -1."""
    if periodic is not None:
        if axis == 0:
            disc.crossed_x += np.int16(forward)
        else:
            disc.crossed_y += np.int16(forward)


@inline
def take_out(disc, i, kind, absorbing, rotation):
    """Remove disc i from the gas if it has escaped; kind: kind of its last event."""
    if absorbing is not None and kind == ESCAPED:
        leave_gas(disc, i, rotation)


@njit
def advance_events(discs, effects, limits, epoch_start, batch, counters):
    """Process events up to the limits, or until the batch is full; records are in order of id.

    Returns the number of rows written, and whether all events up to the time limit have happened.
    """
    record, ids, box = discs
    rows = events = collisions = thermostat_collisions = 0
    now = happened = counters[0].time
    events_at_this_time = counters[0].events_at_this_time
    reached = False
    capacity = batch_capacity(batch)
    while events < limits.events and collisions < limits.collisions and rows < capacity:
        time, what, i, partner, image_x, image_y = next_event(record, box, effects, happened)
        if time > limits.until:
            reached = True
            break
        happened = time
        if what == BOUNDARY_CROSSING:
            cross_boundary(effects.periodic, record[i], partner, image_x)
            continue
        if what == STOP:
            resolve_stop(i, time, effects.piston)
            continue
        disc = record[i]
        clock = epoch_start + time
        if what == DISC:
            images = images_between(effects.periodic, disc, record[partner], (image_x, image_y))
            resolve_pair(disc, record[partner], i, partner, time, images, effects)
            rows += write_pair(batch, rows, clock, record, ids, i, partner, effects)
            collisions += 1
        elif what == WALL:
            resolve_side(disc, i, partner, time, effects)
            rows += write_hit(batch, rows, clock, i, -1 - partner, WALL, disc, effects)
        elif what == SEGMENT:
            images = images_to_wall(effects.periodic, disc, (image_x, image_y))
            kind = resolve_segment(disc, i, partner, time, images, effects.segments, effects)
            rows += write_hit(batch, rows, clock, i, -1 - FIRST_SEGMENT - partner, kind, disc, effects)
            take_out(disc, i, kind, effects.absorbing, effects.rotation)
        elif what == THERMOSTAT:
            resolve_thermostat_collision(disc, i, time, effects.thermostat, effects)
            rows += write_hit(batch, rows, clock, i, BATH, THERMOSTAT, disc, effects)
            thermostat_collisions += 1
        else:
            wall = resolve_piston(disc, i, partner, time, effects.piston, effects)
            rows += write_hit(batch, rows, clock, i, -1 - wall, PISTON, disc, effects)
        events += 1
        events_at_this_time = check_clock(time, now, events_at_this_time, record.shape[0])
        now = time
    add_to_counters(counters[0], events, collisions, thermostat_collisions, now, events_at_this_time)
    return rows, reached


class BruteForce(Method):
    """The brute-force method, with the discs and effects of the current epoch."""

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Process events; see `advance_events`."""
        return advance_events(self.discs, self._effects, limits, epoch_start, batch, counters)
