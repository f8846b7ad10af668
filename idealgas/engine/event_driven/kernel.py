"""The loop over the events of the event-driven method.

A predicted contact belongs to that disc of the pair whose events were predicted more recently. If the partner has had
an event since then, the contact is stale and is predicted again. Either one thread owns all discs, or each of several
threads owns the discs in a slab of the box; see `synchronization`.
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
    """Reason why a disc's events are predicted again. Smaller numbers are codes of cell crossings; see PREDICTION."""

    STALE = SIDE_OF_BOX
    """The contact is stale, and only the contact is predicted again."""
    EVENT = SIDE_OF_BOX + 1
    """An event has changed the stored state of the disc."""
    START = SIDE_OF_BOX + 2
    """An epoch begins."""


@njit
def place(record, ids, position, velocity, state, coarse, absorbing):
    """Begin an epoch: set the records and cells of the discs, and clear the scheduler.

    position: (N, 2) by id, length. velocity: (N, 2) by id, length/time.
    """
    state.cells.head[:] = -1
    if coarse is not None:
        coarse.cells.head[:] = -1
    for i in range(record.shape[0]):
        disc, disc_id = record[U(i)], U(ids[U(i)])
        disc.x, disc.y = position[disc_id, 0], position[disc_id, 1]
        disc.vx, disc.vy = velocity[disc_id, 0], velocity[disc_id, 1]
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
    """Predict those of disc i's next events that may have changed, and schedule the earliest.

    change: a `Repredict`, or the code of the crossing with which the disc has just entered its cell.
    """
    if has_left(record[U(i)], effects.absorbing):
        prediction = state.prediction[U(i)]
        prediction.contact, prediction.partner = NO_CONTACT, -1
        prediction.crossing, prediction.crossing_code = NEVER, SIDE_OF_BOX
    else:
        predict_contact(record, ids, state, i, change, now, effects.segments, effects.noninteracting, effects)
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
    """Remove disc i from its cell and from the gas if it has escaped; kind: kind of its last event."""
    if absorbing is not None and kind == ESCAPED:
        leave(own_cells(state.cells, state.coarse, record[U(i)]), i)
        leave_gas(record[U(i)], ids[U(i)], rotation)


@inline
def resolve_event(record, ids, state, i, partner, at_contact, time, batch, rows, clock, effects):
    """Resolve the next event of disc i and write its rows; return the number of rows, and the kind of the event.

    partner: index of the disc with which disc i collides, or -1. at_contact: whether the event is the predicted contact
    of disc i. time: local time of the event. clock: time of the event since the start of the run.
    """
    prediction, disc, disc_id = state.prediction[U(i)], record[U(i)], np.int64(ids[U(i)])
    if partner >= 0:
        images = images_of(prediction)
        resolve_pair(disc, record[U(partner)], disc_id, np.int64(ids[U(partner)]), time, images, effects)
        return write_pair(batch, rows, clock, record, ids, i, partner, effects), DISC
    if at_contact:
        segment = FIRST_WALL_SEGMENT - prediction.partner
        kind = resolve_segment(disc, disc_id, segment, time, images_of(prediction), effects.segments, effects)
        written = write_hit(batch, rows, clock, disc_id, -1 - FIRST_SEGMENT - segment, kind, disc, effects)
        take_out(record, ids, state, i, kind, effects.absorbing, effects.rotation)
        return written, kind
    if prediction.crossing_code == THERMOSTAT_COLLISION:
        resolve_thermostat_collision(disc, disc_id, time, effects.thermostat, effects)
        return write_hit(batch, rows, clock, disc_id, BATH, THERMOSTAT, disc, effects), THERMOSTAT
    side = prediction.crossing_code - SIDE_OF_BOX
    resolve_side(disc, disc_id, side, time, effects)
    move_to_cell(record, state, i, effects.shear)
    return write_hit(batch, rows, clock, disc_id, -1 - side, WALL, disc, effects), WALL


@inline
def resolve_event_of_piston(record, ids, state, leaf, at_contact, time, batch, rows, clock, piston, effects):
    """Resolve the next event of the piston at a leaf of the schedule; the other arguments are as in `resolve_event`.

    Returns the number of rows written, and the index of the disc that the piston hits; -1 if the piston has reached a
    side of the box or its predicted contact is stale.
    """
    prediction, k = state.prediction[U(leaf)], leaf - record.shape[0]
    i = np.int64(-1)
    written = 0
    if piston is not None:
        if not at_contact:
            resolve_stop(k, time, piston)
        elif record[U(prediction.partner)].count == prediction.partner_count:
            i = np.int64(prediction.partner)
            disc_id = np.int64(ids[U(i)])
            remove(state.tree, state.prediction, ids, i)
            wall = resolve_piston(record[U(i)], disc_id, k, time, piston, effects)
            written = write_hit(batch, rows, clock, disc_id, -1 - wall, PISTON, record[U(i)], effects)
        predict_piston(record, ids, state, leaf, piston, effects)
    return written, i


@njit
def advance_events(discs, state, effects, limits, epoch_start, batch, counters, subdomain):
    """Process events up to the limits, or until the batch is full; at the start of an epoch, first predict all events.

    Returns the number of rows written, and whether all events up to the time limit have happened. subdomain: the slab
    whose events are processed; None for all discs.

    Each round of the loop takes the next event from the schedule and ends in one of four ways:

        1. predict events of discs that the last round changed  ←───────────────────────────────┐
        2. count its event, and stop at a limit                                                 │
        3. take the next event from the schedule                                                │
        4. crossing into a cell: the disc changes its cell ────→ contacts in the new cells ─────┤
        5. stale contact: the partner has had an event since ──→ the contact of this disc ──────┤
        6. other events at this time: order them by ids ───────→ nothing, take the first ───────┤
        7. resolve the event and write its rows ───────────────→ all events of its discs ───────┘

    Events are predicted again for disc i and, unless it is -1, for disc `partner`; `change` is the reason.
    """
    record, ids, _ = discs
    rows = events = collisions = thermostat_collisions = 0
    now, events_at_this_time = counters[0].time, counters[0].events_at_this_time
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
    i = partner = np.int64(-1)
    while True:
        # 1. A single call serves all changes, because a second call would double the machine code.
        while i >= 0:
            predict(record, ids, state, i, change, time, effects, subdomain)
            i, partner = partner, np.int64(-1)
        # 2. Limits are checked only after an event, when no prediction is missing.
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
        # 3. With several threads, each thread waits until its next event may happen.
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
        prefetch_next(state.pipeline, record, state, i, effects.noninteracting)
        # 4. A crossing into another cell does not change the position, velocity and time of a record.
        if not at_contact and prediction.crossing_code < SIDE_OF_BOX:
            change = np.int64(prediction.crossing_code)
            cross_cell(record, state, i, change, effects.periodic, effects.noninteracting)
            continue
        # 5. The event of a pair is also removed from the partner's leaf. Stale contacts of pistons are found in step 7.
        of_piston = i >= record.shape[0]
        tied = False
        if at_contact and prediction.partner >= 0 and not of_piston:
            if record[U(prediction.partner)].count != prediction.partner_count:
                change = np.int64(Repredict.STALE)
                continue
            partner = np.int64(prediction.partner)
            tied = has_other_event(state.tree, state.prediction, i, partner, time) and state.tree.tie_time[0] != time
            remove(state.tree, state.prediction, ids, partner)
        # 6. Once the ties at this time are resolved, the schedule returns its events in order.
        next_time, _ = next_event(state.tree)
        if tied or (next_time == time and state.tree.tie_time[0] != time):
            if subdomain is not None and partner >= 0 and not is_owned(state, partner, subdomain):
                partner = np.int64(-1)
            resolve_ties(state.tree, state.prediction, ids, i, partner)
            change = np.int64(Repredict.STALE)
            i = partner = np.int64(-1)
            continue
        # 7. A collision, a hit or a thermostat collision; if a piston hits a disc, i becomes the index of this disc.
        clock = epoch_start + time
        if of_piston:
            written, i = resolve_event_of_piston(
                record, ids, state, i, at_contact, time, batch, rows, clock, effects.piston, effects
            )
            if i < 0:
                change = np.int64(Repredict.STALE)
                continue
        else:
            written, kind = resolve_event(record, ids, state, i, partner, at_contact, time, batch, rows, clock, effects)
            collisions += 1 if kind == DISC else 0
            thermostat_collisions += 1 if kind == THERMOSTAT else 0
        rows += written
        change = np.int64(Repredict.EVENT)
    if subdomain is not None:
        finish(subdomain, reached)
    add_to_counters(counters[0], events, collisions, thermostat_collisions, now, events_at_this_time)
    return rows, reached
