"""Synchronization of threads: the loop in which a thread waits until the next event of its slab may happen.

The result must be the same as with one thread, which processes all events in order of time. This is achieved in two
steps: an event waits until it appears to be the first of all events with which it does not commute, and then this is
checked. Waiting makes violations rare, but the result relies only on the check: an event that comes too late has not
written anything yet; its thread raises a flag, the slice is rolled back, and one thread repeats the slice.

Events that commute. An event writes the records, predictions and lists of one row of cells or of two adjacent rows: the
rows of its discs, or the rows between which a disc crosses. It then predicts the next events of these discs, for which
it reads the rows next to them. Two events therefore commute if at least one row lies between the rows that they write.
In the slab above an interface, with HALO = 4:

    row
     5 │ interior     written by events of the interior: rows 3 and above
     4 │ ──────────   (a disc in row 4 may cross to row 3)
     3 │ halo
     2 │              halo events that write rows 0 and 1 only (SAFE_DEPTH) commute with events of the interior
     1 │
     0 │ ──────────
    ═══╪═══════════   interface: a thread that processes a halo event holds its lock
    -1 │ halo of the  written by events of the slab below: rows 0 and below, because only discs of the two rows
    -2 │ neighbour    at the interface may collide across it, or cross it

Events of the interior commute with all events of other threads: rows 1 and 2 lie between them. Halo events at different
interfaces commute, because a slab has at least MIN_ROWS rows. `is_in_order` checks events that do not commute.

Clocks. The clock of a slab is the time of its next event. Loads acquire and stores release (see `atomics`): a thread
that reads the clock of a neighbour also sees everything that the neighbour did before it set the clock. An outdated
value is an earlier time; it may make a thread wait longer than necessary, but never proceed too early. A clock is set
back only when its slab receives a disc that has an earlier event; an event of the neighbour that should have waited may
then have happened already.

Threads cannot deadlock: the earliest of all next events has no earlier clock to wait for; no thread holds a lock while
it waits, except a thread that sends a disc; and threads that wait continue to receive discs.
"""

import numpy as np

from idealgas.engine.event_driven.prediction import contact_is_next
from idealgas.engine.event_driven.scheduler import next_event
from idealgas.engine.parallel.atomics import add, load, store, wait
from idealgas.engine.parallel.subdomain import (
    ABORTED,
    ACTIVE,
    CLOCK,
    DONE,
    FLAG,
    FOREIGN,
    FULL,
    HALO,
    HIGH,
    LOW,
    MAX_SIMULTANEOUS,
    SAFE_DEPTH,
    TIE,
    VIOLATION,
    abort,
    clock_word,
    has_message,
    lock_word,
    publish_clock,
    receive,
    try_lock,
    unlock,
)
from idealgas.jit import inline

LATER, FIRST, TIED = range(3)
"""Order of an event relative to the next event of a neighbour: possibly later, certainly earlier, or simultaneous."""

U = np.uintp


@inline
def is_owned(state, i, sub):
    """Whether this thread owns disc i."""
    return sub.low <= state.cells.link[U(i)].row < sub.high


@inline
def count_simultaneous(time, now, events_at_this_time, sub):
    """Count an event at `time`; return the time of the latest event, and the number of consecutive events then."""
    check_rows(time, sub)
    if time < now:  # the clock was set back
        return now, events_at_this_time
    return time, (events_at_this_time + 1 if time == now else 0)


@inline
def check_rows(time, sub):
    """Note an event with rows; abort if the previous one had the same time and a disc was received in between.

    If the received disc takes part in the event, the order of the two events is undefined, and the merge cannot detect
    this because their rows are adjacent.
    """
    private = sub.private[0]
    if private.unchecked > 0:
        private.unchecked -= 1
        if time == private.row_time:
            abort(sub, TIE)
    private.row_time = time


@inline
def finish(sub, reached):
    """End a thread's work; if it did not reach its time limit, abort the slice."""
    unlock(sub)
    if not reached:
        abort(sub, FULL)


@inline
def is_interior(row, sub):
    """Whether a row lies in the slab and in neither of its halos."""
    first, end = sub.interior
    return U(np.int64(row) - first) < U(end - first)


@inline
def is_halo_event(ids, state, i, sub):
    """Whether disc i's next event involves rows outside the interior."""
    prediction = state.prediction[U(i)]
    j = prediction.partner
    if j >= 0 and contact_is_next(prediction, ids, i) and not is_interior(state.cells.link[U(j)].row, sub):
        return True
    return not is_interior(state.cells.link[U(i)].row, sub)


@inline
def halo_of(row, sub):
    """Interfaces whose halos contain a row of the slab: a sum of LOW and HIGH."""
    low = LOW if sub.below >= 0 and row < sub.low + HALO else 0
    return low | (HIGH if sub.above >= 0 and row >= sub.high - HALO else 0)


@inline
def location_of(ids, state, i, sub):
    """Location of disc i's next event: a sum of LOW, HIGH and FOREIGN; 0 in the interior."""
    where = halo_of(state.cells.link[U(i)].row, sub)
    prediction = state.prediction[U(i)]
    j = prediction.partner
    if j >= 0 and contact_is_next(prediction, ids, i):
        row = state.cells.link[U(j)].row
        where |= halo_of(row, sub) if sub.low <= row < sub.high else FOREIGN
    return where


@inline
def depth_of(ids, state, i, where, sub):
    """Largest distance, in rows, from the interfaces of a halo event to the rows that it writes in this slab."""
    row = np.int64(state.cells.link[U(i)].row)
    first = last = row
    prediction = state.prediction[U(i)]
    if contact_is_next(prediction, ids, i):
        j = prediction.partner
        if j >= 0 and is_owned(state, j, sub):
            first = min(first, np.int64(state.cells.link[U(j)].row))
            last = max(last, np.int64(state.cells.link[U(j)].row))
    elif prediction.crossing_code == 2:
        first -= 1
    elif prediction.crossing_code == 3:
        last += 1
    depth = last - sub.low if where & LOW else 0
    return max(depth, sub.high - 1 - first if where & HIGH else 0)


@inline
def is_misplaced(record, state, i, where, sub):
    """Whether disc i will collide with a disc of another thread that is not in the adjacent row across the interface.

    If the partner has had an event since the prediction, disc i does not collide with it.
    """
    prediction = state.prediction[U(i)]
    partner = record[U(prediction.partner)]
    if partner.count != prediction.partner_count:
        return False
    row, opposite = np.int64(state.cells.link[U(i)].row), state.cells.link[U(prediction.partner)].row
    below = sub.low - 1 if sub.low > 1 else state.cells.rows - 2
    above = sub.high if sub.high < state.cells.rows - 1 else 1
    at_low = where & HIGH == 0 and row == sub.low and opposite == below
    at_high = where & LOW == 0 and row == sub.high - 1 and opposite == above
    return not (at_low or at_high)


@inline
def order_to_neighbour(state, i, time, rank, sub):
    """Order of a halo event of disc i relative to all future events of a neighbour.

    Both discs of a pair across an interface predict the same event; the slab with the smaller rank processes it.
    """
    clock = load(sub.times, clock_word(rank))
    if clock != time:
        return FIRST if clock > time else LATER
    if load(sub.times, clock_word(rank) + 1) != time:  # the neighbour has not announced a halo event at this time
        return LATER
    j = load(sub.words, clock_word(rank) + 2)
    a, c = state.prediction[U(i)], state.prediction[U(j)]
    if a.partner == j and c.partner == i and a.contact == time and c.contact == time:
        return FIRST if sub.rank < rank else LATER
    return TIED if load(sub.times, clock_word(rank)) == time else LATER


@inline
def order_to_neighbours(state, i, time, where, sub):
    """Order of a halo event of disc i relative to all future events of the neighbours that it involves."""
    low = high = FIRST
    if sub.below >= 0 and where & (LOW | FOREIGN):
        low = order_to_neighbour(state, i, time, sub.rank_below, sub)
    if sub.above >= 0 and where & (HIGH | FOREIGN):
        high = order_to_neighbour(state, i, time, sub.rank_above, sub)
    return TIED if low == TIED or high == TIED else min(low, high)


@inline
def earliest_clock(sub):
    """Earliest clock of the neighbours."""
    earliest = np.inf
    if sub.below >= 0:
        earliest = min(earliest, load(sub.times, clock_word(sub.rank_below)))
    if sub.above >= 0:
        earliest = min(earliest, load(sub.times, clock_word(sub.rank_above)))
    return earliest


@inline
def is_in_order(ids, state, i, time, where, sub):
    """Note disc i's event and return True, or return False if an event that should have waited for it has happened.

    Proof: Let B be disc i's event, and A an event that has happened although it does not commute with B and is not
    earlier. As explained above, A is an event of the same slab or a halo event at an interface of B. Within a slab,
    events happen in order of time, unless the slab receives a disc between A and B. This leaves four cases:

        B            A                             happened too early if
        interior     interior event of this slab   A came before the last message, and B is not later
        interior     halo event of this slab       likewise
        halo event   interior event of this slab   likewise, and B writes rows deeper than SAFE_DEPTH
        halo event   halo event, same interface    B is not later than the latest event there, of either thread

    The times on the right are known: `message_interior` and `message_halo` are the times of the latest events before
    the last message, and the time of the latest event at an interface is stored next to its lock, which this thread
    holds. Simultaneous halo events are in order if both are events of this slab and it received no disc in between.
    """
    private = sub.private[0]
    if not where & (LOW | HIGH):
        if time <= private.message_interior or time <= private.message_halo:
            return False
        private.interior = max(private.interior, time)
        return True
    if time <= private.message_interior and depth_of(ids, state, i, where, sub) > SAFE_DEPTH:
        return False
    for side in (LOW, HIGH):
        if where & side:
            word = lock_word(sub, sub.below if side == LOW else sub.above) + 1
            latest = sub.times[U(word)]
            if time < latest or (time == latest and time != (private.low if side == LOW else private.high)):
                return False
            sub.times[U(word)] = time
    if where & LOW:
        private.low = time
    if where & HIGH:
        private.high = time
    private.halo = max(private.halo, time)
    return True


@inline
def clock_advances(time, sub):
    """Note an event; return whether the clock advances, or stands still for fewer than MAX_SIMULTANEOUS events."""
    private = sub.private[0]
    if time <= private.last:
        private.simultaneous += 1
        return time == private.last and private.simultaneous < MAX_SIMULTANEOUS
    private.simultaneous = 0
    private.last = time
    return True


@inline
def may_happen(record, ids, state, i, time, sub):
    """Whether disc i's event, the next event of this slab, may happen now.

    Returns 1 if it may, with its interfaces locked, 0 if not, or ABORTED. An event of the interior may happen unless it
    is far ahead of the neighbours. A halo event is announced, so that a neighbour can see whether both have predicted
    the same event. Once the event appears to be the first, its interfaces are locked, and the decision is repeated,
    because the neighbour may have collided with the partner, moved it or sent a disc before they were locked.
    """
    private = sub.private[0]
    where = 0
    if is_halo_event(ids, state, i, sub):
        # 1. Announce the event: store the disc and the time before the clock, which the neighbour reads first.
        where = location_of(ids, state, i, sub)
        store(sub.words, clock_word(sub.rank) + 2, i)
        store(sub.times, clock_word(sub.rank) + 1, time)
        publish_clock(sub, time)
        # 2. Wait for earlier events of the neighbours, and for the locks.
        if order_to_neighbours(state, i, time, where, sub) == LATER or not try_lock(sub, where):
            return 0
        # 3. Decide again while holding the locks.
        order = LATER
        if not has_message(sub) and location_of(ids, state, i, sub) == where:
            order = order_to_neighbours(state, i, time, where, sub)
        if order == TIED:
            return abort(sub, TIE)
        if order == LATER:
            unlock(sub)
            return 0
        if where & FOREIGN and is_misplaced(record, state, i, where, sub):
            return abort(sub, VIOLATION)
    else:
        publish_clock(sub, time)
        if time > private.horizon:  # the neighbours' clocks are read only if they may matter
            private.horizon = earliest_clock(sub) + sub.lead
            if time > private.horizon:
                return 0
    # 4. Whatever the clocks have shown, the event must be in order.
    if not clock_advances(time, sub):
        return abort(sub, CLOCK)
    if not is_in_order(ids, state, i, time, where, sub):
        return abort(sub, VIOLATION)
    return 1


@inline
def wait_for_event(record, ids, state, until, sub):
    """Wait until this slab's next event may happen; return the index of its disc, or DONE or ABORTED."""
    private = sub.private[0]
    unlock(sub)
    rounds = 0
    while load(sub.words, FLAG) == 0:
        if has_message(sub):
            receive(ids, state, until, sub)
        time, i = next_event(state.tree)
        if time <= until:
            decision = may_happen(record, ids, state, i, time, sub)
            if decision != 0:
                return i if decision == 1 else np.int64(ABORTED)
        else:
            publish_clock(sub, time)
            if not private.idle:
                private.idle = 1
                add(sub.words, ACTIVE, np.int64(-1))
            if load(sub.words, ACTIVE) == 0:
                return np.int64(DONE)
        rounds = wait(rounds)
    return np.int64(ABORTED)
