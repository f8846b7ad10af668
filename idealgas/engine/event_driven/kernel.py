"""The loop over the events of the event-driven method.

A contact belongs to the disc of the pair that predicted it last; if its partner has had an event since, it is stale and
predicted again. One thread may own all discs, or several threads one slab of the box each, see `synchronization`.
"""

from enum import IntEnum

import numpy as np

from idealgas.columns import BATH, FIRST_SEGMENT
from idealgas.engine.event_driven.cells import cell_index, clear_cells, enter, find_cell, leave, own_cells
from idealgas.engine.event_driven.contacts import predict_contact
from idealgas.engine.event_driven.crossings import cross_cell, is_thermostat_collision, move_to_cell, predict_crossing
from idealgas.engine.event_driven.piston import is_piston, offer_to_pistons, predict_piston, predict_pistons
from idealgas.engine.event_driven.prediction import (
    SIDE_OF_BOX,
    contact_is_next,
    images_of,
    predict_nothing,
    segment_of,
)
from idealgas.engine.event_driven.prefetch import prefetch_next
from idealgas.engine.event_driven.scheduler import clear, has_other_event, is_resolved, remove, resolve_ties
from idealgas.engine.event_writer import ESCAPED, PISTON, THERMOSTAT, WALL, batch_capacity, write_hit, write_pair
from idealgas.engine.parallel.subdomain import DONE
from idealgas.engine.parallel.synchronization import (
    count_simultaneous,
    finish,
    if_owned,
    next_event,
    push_to_owner,
)
from idealgas.engine.records import add_to_counters, reload
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

U = np.uintp


class Repredict(IntEnum):
    """Why a disc's events are predicted again; smaller numbers are codes of cell crossings, see PREDICTION."""

    STALE = SIDE_OF_BOX
    """Its contact is stale: only the contact is predicted again."""
    EVENT = SIDE_OF_BOX + 1
    """Its record has changed in an event."""
    START = SIDE_OF_BOX + 2
    """An epoch begins."""


@inline
def predict(record, ids, state, i, change, now, effects, subdomain):
    """Predict disc i's next events again, as far as they may have changed, and schedule the earliest of them.

    change: a `Repredict`, or the code of the crossing by which the disc entered its cell.
    """
    if has_left(record[U(i)], effects.absorbing):
        predict_nothing(state.prediction[U(i)])
    else:
        predict_contact(record, ids, state, i, change, now, effects)
        if change != Repredict.STALE:
            predict_crossing(record, ids, state, i, now, effects)
    push_to_owner(ids, state, i, subdomain)
    if change > Repredict.STALE:
        offer_to_pistons(record, ids, state, i, effects.piston, effects)


@inline
def take_out(record, ids, state, i, kind, absorbing, rotation):
    """Take disc i out of its cell and of the gas if its event of this kind was the last."""
    if absorbing is not None and kind == ESCAPED:
        cells = own_cells(state.cells, state.coarse, record[U(i)])
        leave(cells, i, cell_index(cells, i))
        leave_gas(record[U(i)], ids[U(i)], rotation)


@njit
def place(record, ids, position, velocity, state, absorbing):
    """Begin an epoch: fill records and cells from positions and velocities (N, 2) by id, and clear the scheduler."""
    clear_cells(state.cells, state.coarse)
    for i in range(record.shape[0]):
        reload(record[U(i)], U(ids[U(i)]), position, velocity)
        cells = own_cells(state.cells, state.coarse, record[U(i)])
        if has_left(record[U(i)], absorbing):
            cells.link[U(i)].column = cells.link[U(i)].row = 1
        else:
            find_cell(cells, i, record[U(i)])
            enter(cells, i, cell_index(cells, i))
    clear(state.tree)


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
    capacity = batch_capacity(batch)
    if state.unpredicted[0]:
        state.unpredicted[0] = False
        predict_pistons(record, ids, state, effects.piston, effects)
        for k in range(record.shape[0]):
            if if_owned(state, k, subdomain) >= 0:
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
                now, events_at_this_time = count_simultaneous(
                    time, now, events_at_this_time, record.shape[0], subdomain
                )
            if (events >= limits.events) | (collisions >= limits.collisions) | (rows >= capacity):
                break
        i = next_event(record, ids, state, limits.until, subdomain)
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
        of_piston = is_piston(i, ids, effects.piston)
        tied = False
        if at_contact and prediction.partner >= 0 and not of_piston:
            if record[U(prediction.partner)].count != prediction.partner_count:
                change = np.int64(Repredict.STALE)
                continue
            other = np.int64(prediction.partner)
            tied = has_other_event(state.tree, state.prediction, i, other, time) and state.tree.tie_time[0] != time
            remove(state.tree, state.prediction, ids, other)
        if tied or not is_resolved(state.tree, time):
            resolve_ties(state.tree, state.prediction, ids, i, if_owned(state, other, subdomain))
            change = np.int64(Repredict.STALE)
            i = other = np.int64(-1)
            continue
        if of_piston:
            leaf, piston = i, i - record.shape[0]
            i = np.int64(prediction.partner)
            hit = at_contact and record[U(i)].count == prediction.partner_count
            if hit:
                remove(state.tree, state.prediction, ids, i)
                wall = resolve_piston(record[U(i)], ids[U(i)], piston, time, effects.piston, effects)
                rows += write_hit(batch, rows, epoch_start + time, ids[U(i)], -1 - wall, PISTON, record[U(i)], effects)
            elif not at_contact:
                resolve_stop(piston, time, effects.piston)
            predict_piston(record, ids, state, leaf, effects.piston, effects)
            if not hit:
                change = np.int64(Repredict.STALE)
                i = np.int64(-1)
                continue
        elif other >= 0:
            images = images_of(prediction)
            resolve_pair(record[U(i)], record[U(other)], ids[U(i)], ids[U(other)], time, images, effects)
            rows += write_pair(batch, rows, epoch_start + time, record, ids, i, other, effects)
            collisions += 1
        elif at_contact:
            segment = segment_of(prediction.partner)
            kind = resolve_segment(
                record[U(i)], ids[U(i)], segment, time, images_of(prediction), effects.segments, effects
            )
            wall = -1 - FIRST_SEGMENT - segment
            rows += write_hit(batch, rows, epoch_start + time, ids[U(i)], wall, kind, record[U(i)], effects)
            take_out(record, ids, state, i, kind, effects.absorbing, effects.rotation)
        elif is_thermostat_collision(prediction.crossing_code, effects.thermostat):
            thermostat_collisions += 1
            resolve_thermostat_collision(record[U(i)], ids[U(i)], time, effects.thermostat, effects)
            rows += write_hit(batch, rows, epoch_start + time, ids[U(i)], BATH, THERMOSTAT, record[U(i)], effects)
        else:
            side = prediction.crossing_code - SIDE_OF_BOX
            resolve_side(record[U(i)], ids[U(i)], side, time, effects)
            move_to_cell(record, state, i, effects.shear)
            rows += write_hit(batch, rows, epoch_start + time, ids[U(i)], -1 - side, WALL, record[U(i)], effects)
        change = np.int64(Repredict.EVENT)
    finish(subdomain, reached)
    add_to_counters(counters[0], events, collisions, thermostat_collisions, now, events_at_this_time)
    return rows, reached
