"""The loop over the events of the event-driven method.

A contact belongs to the disc of the pair that predicted it last; if its partner has had an event since, it is stale and
predicted again. One thread may own all discs, or several threads one slab of the box each, see `synchronization`.
"""

from enum import IntEnum

import numpy as np

from idealgas.columns import BATH, FIRST_SEGMENT
from idealgas.engine.event_driven.cells import enter, find_cell, leave, own_cells
from idealgas.engine.event_driven.contacts import predict_contact
from idealgas.engine.event_driven.crossings import cross_cell, move_to_cell, predict_crossing
from idealgas.engine.event_driven.piston import offer_to_pistons, predict_piston, predict_pistons
from idealgas.engine.event_driven.prediction import (
    FIRST_WALL_SEGMENT,
    NO_CONTACT,
    SIDE_OF_BOX,
    contact_is_next,
    images_of,
)
from idealgas.engine.event_driven.prediction import THERMOSTAT as THERMOSTAT_COLLISION
from idealgas.engine.event_driven.prefetch import prefetch_next
from idealgas.engine.event_driven.scheduler import clear, has_other_event, next_event, push, remove, resolve_ties
from idealgas.engine.event_writer import DISC, ESCAPED, NO_END, PISTON, THERMOSTAT, WALL, write_hit, write_pair
from idealgas.engine.parallel.subdomain import DONE, migrate
from idealgas.engine.parallel.synchronization import count_simultaneous, finish, is_owned, wait_for_event
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
from idealgas.physics.motion import NEVER

U = np.uintp


class Repredict(IntEnum):
    """Why a disc's events are predicted again; smaller numbers are codes of cell crossings, see PREDICTION."""

    STALE = SIDE_OF_BOX
    """Its contact is stale: only the contact is predicted again."""
    EVENT = SIDE_OF_BOX + 1
    """Its record has changed in an event."""
    START = SIDE_OF_BOX + 2
    """An epoch begins."""


@njit
def place(record, ids, position, velocity, state, coarse, absorbing):
    """Begin an epoch: fill records and cells from positions and velocities (N, 2) by id, and clear the scheduler."""
    state.cells.head[:] = -1
    if coarse is not None:
        coarse.cells.head[:] = -1
    for i in range(record.shape[0]):
        disc, own = record[U(i)], U(ids[U(i)])
        disc.x, disc.y = position[own, 0], position[own, 1]
        disc.vx, disc.vy = velocity[own, 0], velocity[own, 1]
        disc.t = 0.0
        disc.crossed_x = disc.crossed_y = 0
        disc.count = 0
        if absorbing is not None and has_left(disc, absorbing):
            state.cells.link[U(i)].column = state.cells.link[U(i)].row = 1
        else:
            cells = own_cells(state.cells, coarse, disc)
            find_cell(cells, i, disc)
            enter(cells, i)
    clear(state.tree)


@inline
def predict(record, ids, state, i, change, now, effects, subdomain):
    """Predict disc i's next events again, as far as they may have changed, and schedule the earliest of them.

    change: a `Repredict`, or the code of the crossing by which the disc entered its cell.
    """
    if has_left(record[U(i)], effects.absorbing):
        prediction = state.prediction[U(i)]
        prediction.contact, prediction.partner = NO_CONTACT, -1
        prediction.crossing, prediction.crossing_code = NEVER, SIDE_OF_BOX
    else:
        predict_contact(record, ids, state, i, change, now, effects.segments, effects)
        if change != Repredict.STALE:
            predict_crossing(record, ids, state, i, now, effects.thermostat, effects.vibration, effects)
    if subdomain is not None and not is_owned(state, i, subdomain):
        migrate(ids, state, i, subdomain)
    else:
        push(state.tree, state.prediction, ids, i)
    if change > Repredict.STALE:
        offer_to_pistons(record, ids, state, i, effects.piston, effects)


@inline
def take_out(record, ids, state, i, kind, absorbing, rotation):
    """Take disc i out of its cell and of the gas if its event of this kind was the last."""
    if absorbing is not None and kind == ESCAPED:
        leave(own_cells(state.cells, state.coarse, record[U(i)]), i)
        leave_gas(record[U(i)], ids[U(i)], rotation)


@inline
def resolve_event(record, ids, state, i, other, at_contact, time, batch, rows, clock, effects):
    """Resolve the next event of disc i, which is a collision with disc `other` unless that is -1, and write its rows.

    time: of the event, local. clock: the same since the start of the run. Returns the number of rows, and the kind of
    the event.
    """
    prediction, disc, own = state.prediction[U(i)], record[U(i)], np.int64(ids[U(i)])
    if other >= 0:
        images = images_of(prediction)
        resolve_pair(disc, record[U(other)], own, np.int64(ids[U(other)]), time, images, effects)
        return write_pair(batch, rows, clock, record, ids, i, other, effects), DISC
    if at_contact:
        segment = FIRST_WALL_SEGMENT - prediction.partner
        kind = resolve_segment(disc, own, segment, time, images_of(prediction), effects.segments, effects)
        written = write_hit(batch, rows, clock, own, -1 - FIRST_SEGMENT - segment, kind, disc, effects)
        take_out(record, ids, state, i, kind, effects.absorbing, effects.rotation)
        return written, kind
    if prediction.crossing_code == THERMOSTAT_COLLISION:
        resolve_thermostat_collision(disc, own, time, effects.thermostat, effects)
        return write_hit(batch, rows, clock, own, BATH, THERMOSTAT, disc, effects), THERMOSTAT
    side = prediction.crossing_code - SIDE_OF_BOX
    resolve_side(disc, own, side, time, effects)
    move_to_cell(record, state, i, effects.shear)
    return write_hit(batch, rows, clock, own, -1 - side, WALL, disc, effects), WALL


@inline
def resolve_event_of_piston(record, ids, state, leaf, at_contact, time, batch, rows, clock, piston, effects):
    """Resolve the next event of a piston, whose leaf in the schedule is given; arguments as of `resolve_event`.

    Returns the number of rows, and the index of the disc that it hits, or -1: it has met a side, or its contact is
    stale.
    """
    prediction, k = state.prediction[U(leaf)], leaf - record.shape[0]
    i = np.int64(-1)
    written = 0
    if piston is not None:
        if not at_contact:
            resolve_stop(k, time, piston)
        elif record[U(prediction.partner)].count == prediction.partner_count:
            i = np.int64(prediction.partner)
            own = np.int64(ids[U(i)])
            remove(state.tree, state.prediction, ids, i)
            wall = resolve_piston(record[U(i)], own, k, time, piston, effects)
            written = write_hit(batch, rows, clock, own, -1 - wall, PISTON, record[U(i)], effects)
        predict_piston(record, ids, state, leaf, piston, effects)
    return written, i


@njit
def advance_events(record, ids, state, effects, limits, epoch_start, batch, counters, subdomain):
    """Process events up to the limits, or until the batch is full; at the start of an epoch, predict all of them first.

    Returns the number of rows written, and whether all events up to the limit of time have happened. subdomain: the
    slab whose events these are; None for all discs.
    """
    events = 0
    collisions = 0
    thermostat_collisions = 0
    rows = 0
    now = counters[0].time
    events_at_this_time = counters[0].events_at_this_time
    reached = False
    capacity = NO_END
    if batch is not None:
        capacity = batch.time.shape[0] - 1  # a pair needs two rows
    if state.unpredicted[0]:
        state.unpredicted[0] = False
        predict_pistons(record, ids, state, effects.piston, effects)
        for k in range(record.shape[0]):
            if subdomain is None or is_owned(state, k, subdomain):
                predict(record, ids, state, k, np.int64(Repredict.START), 0.0, effects, subdomain)
    time = 0.0
    change = np.int64(Repredict.START)
    i = other = np.int64(-1)
    while True:
        while i >= 0:  # one call for all changes: another would double the machine code
            predict(record, ids, state, i, change, time, effects, subdomain)
            i, other = other, np.int64(-1)
        if change > Repredict.STALE:
            if change == Repredict.EVENT:
                events += 1
                if subdomain is not None:
                    now, events_at_this_time = count_simultaneous(time, now, events_at_this_time, subdomain)
                else:
                    events_at_this_time = check_clock(time, now, events_at_this_time, record.shape[0])
                    now = time
            if (events >= limits.events) | (collisions >= limits.collisions) | (rows >= capacity):
                break
        if subdomain is not None:
            i = wait_for_event(record, ids, state, limits.until, subdomain)
        else:
            next_time, i = next_event(state.tree)
            if next_time > limits.until:
                i = np.int64(DONE)
        if i < 0:
            reached = i == DONE
            break
        prediction = state.prediction[U(i)]
        at_contact = contact_is_next(prediction, ids, i)
        time = prediction.contact if at_contact else prediction.crossing
        remove(state.tree, state.prediction, ids, i)
        prefetch_next(state.pipeline, record, state, i)
        if not at_contact and prediction.crossing_code < SIDE_OF_BOX:
            change = np.int64(prediction.crossing_code)
            cross_cell(record, state, i, change, effects.periodic)
            continue
        of_piston = i >= record.shape[0]
        tied = False
        if at_contact and prediction.partner >= 0 and not of_piston:
            if record[U(prediction.partner)].count != prediction.partner_count:
                change = np.int64(Repredict.STALE)
                continue
            other = np.int64(prediction.partner)
            tied = has_other_event(state.tree, state.prediction, i, other, time) and state.tree.tie_time[0] != time
            remove(state.tree, state.prediction, ids, other)
        next_time, _ = next_event(state.tree)
        if tied or (next_time == time and state.tree.tie_time[0] != time):
            if subdomain is not None and other >= 0 and not is_owned(state, other, subdomain):
                other = np.int64(-1)
            resolve_ties(state.tree, state.prediction, ids, i, other)
            change = np.int64(Repredict.STALE)
            i = other = np.int64(-1)
            continue
        clock = epoch_start + time
        if of_piston:
            written, i = resolve_event_of_piston(
                record, ids, state, i, at_contact, time, batch, rows, clock, effects.piston, effects
            )
            if i < 0:
                change = np.int64(Repredict.STALE)
                continue
        else:
            written, kind = resolve_event(record, ids, state, i, other, at_contact, time, batch, rows, clock, effects)
            collisions += 1 if kind == DISC else 0
            thermostat_collisions += 1 if kind == THERMOSTAT else 0
        rows += written
        change = np.int64(Repredict.EVENT)
    if subdomain is not None:
        finish(subdomain, reached)
    add_to_counters(counters[0], events, collisions, thermostat_collisions, now, events_at_this_time)
    return rows, reached
