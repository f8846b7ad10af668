"""Whose turn it is: the loop in which a thread waits until the next event of its strip may happen.

Two events commute unless one writes rows that the other reads or writes; those that do not must happen in the order of
their times. A thread whose clock was set back may have gone too far. All that could have happened in another order is
noticed before anything is touched: the thread then raises a flag, and all give up what they have done, to be done by
one thread. The argument in full: engine/README.md.
"""

import numpy as np

from idealgas.engine.event_driven.prediction import contact_is_next
from idealgas.engine.event_driven.scheduler import next_disc, next_time, push
from idealgas.engine.parallel.atomics import add, load, pause, store, wait
from idealgas.engine.parallel.subdomain import (
    ABANDONED,
    ACTIVE,
    CLOCK,
    DEEPEST,
    FLAG,
    FOREIGN,
    FULL,
    HIGH,
    LOW,
    MOST_AT_ONCE,
    OVER,
    TIE,
    VIOLATION,
    ZONE,
    abandon,
    absorb,
    announce,
    clock_word,
    hand_over,
    is_posted,
    lock_word,
    try_lock,
    unlock,
)
from idealgas.engine.records import check_clock
from idealgas.jit import inline

U = np.uintp


@inline
def next_turn(record, ids, state, until, border):
    """Index of the disc with the next event up to a time, or OVER.

    With a border, it is one that may happen now, or ABANDONED.
    """
    if border is not None:
        return wait_for_turn(record, ids, state, until, border)
    if next_time(state.tree) > until:
        return np.int64(OVER)
    return next_disc(state.tree)


@inline
def push_to_owner(record, ids, state, i, border):
    """Enter disc i's next event in the schedule of the thread that owns the disc."""
    if border is not None and not border.low <= record[U(i)].row < border.high:
        hand_over(ids, state, i, border)
    else:
        push(state.tree, state.prediction, ids, i)


@inline
def in_own_schedule(record, j, border):
    """Disc j if the thread has its events in its schedule, -1 if another has them; j: -1 for no disc."""
    if border is not None and j >= 0 and not border.low <= record[U(j)].row < border.high:
        return np.int64(-1)
    return j


@inline
def count_at_one_time(time, now, events_at_this_time, n, border):
    """Time of the latest event, after one at `time`, and number of events in a row then; n: number of discs."""
    if border is None:
        return time, check_clock(time, now, events_at_this_time, n)
    note_rows(time, border)
    if time < now:  # the clock was set back
        return now, events_at_this_time
    return time, (events_at_this_time + 1 if time == now else 0)


@inline
def note_rows(time, b):
    """Note an event with rows; give up if it has the time of the one before, and a disc was posted in between.

    If that disc is in this event, nobody has asked which of the two comes first, and their rows stand side by side.
    """
    own = b.own[0]
    if own.posted > 0:
        own.posted -= 1
        if time == own.row_time:
            abandon(b, TIE)
    own.row_time = time


@inline
def leave(border, reached):
    """End a thread's work; where it did not reach its limit, all others are to end theirs."""
    if border is not None:
        unlock(border)
        if not reached:
            abandon(border, FULL)


@inline
def is_inside(row, b):
    """Whether a row lies in the strip, and in no border's zone."""
    first, end = b.inside
    return U(np.int64(row) - first) < U(end - first)


@inline
def is_at_border(record, ids, state, i, b):
    """Whether disc i's next event concerns rows that are not inside."""
    prediction = state.prediction[U(i)]
    j = prediction.partner
    if j >= 0 and contact_is_next(prediction, ids, i) and not is_inside(record[U(j)].row, b):
        return True
    return not is_inside(record[U(i)].row, b)


@inline
def zone_of(row, b):
    """Borders in whose zone a row of the strip lies."""
    low = LOW if b.below >= 0 and row < b.low + ZONE else 0
    return low | (HIGH if b.above >= 0 and row >= b.high - ZONE else 0)


@inline
def place_of(record, ids, state, i, b):
    """Where disc i's next event is: a sum of LOW, HIGH and FOREIGN; 0 inside."""
    where = zone_of(record[U(i)].row, b)
    prediction = state.prediction[U(i)]
    j = prediction.partner
    if j >= 0 and contact_is_next(prediction, ids, i):
        row = record[U(j)].row
        where |= zone_of(row, b) if b.low <= row < b.high else FOREIGN
    return where


@inline
def depth_of(record, ids, state, i, where, b):
    """Largest distance, in rows, of what disc i's event writes in this strip from the borders at which it is."""
    row = np.int64(record[U(i)].row)
    first = last = row
    prediction = state.prediction[U(i)]
    if contact_is_next(prediction, ids, i):
        j = prediction.partner
        if j >= 0 and b.low <= record[U(j)].row < b.high:
            first = min(first, np.int64(record[U(j)].row))
            last = max(last, np.int64(record[U(j)].row))
    elif prediction.crossing_code == 2:
        first -= 1
    elif prediction.crossing_code == 3:
        last += 1
    depth = last - b.low if where & LOW else 0
    return max(depth, b.high - 1 - first if where & HIGH else 0)


@inline
def is_misplaced(record, state, i, where, b):
    """Whether disc i is to meet a disc of another thread that is not in the row beside its own, across the border.

    If that disc has had an event since, disc i does not meet it.
    """
    prediction = state.prediction[U(i)]
    partner = record[U(prediction.partner)]
    if partner.count != prediction.partner_count:
        return False
    row = np.int64(record[U(i)].row)
    below = b.low - 1 if b.low > 1 else state.cells.rows - 2
    above = b.high if b.high < state.cells.rows - 1 else 1
    at_low = where & HIGH == 0 and row == b.low and partner.row == below
    at_high = where & LOW == 0 and row == b.high - 1 and partner.row == above
    return not (at_low or at_high)


@inline
def may_pass(state, i, time, neighbour, b):
    """Whether an event of disc i at a border precedes all that a neighbour has before it, or 2 for a tie.

    Both discs of a pair across the border foretell one event: the strip with the smaller number does it.
    """
    theirs = load(b.times, clock_word(neighbour))
    if theirs != time:
        return 1 if theirs > time else 0
    if load(b.times, clock_word(neighbour) + 1) != time:
        return 0
    j = load(b.words, clock_word(neighbour) + 2)
    a, c = state.prediction[U(i)], state.prediction[U(j)]
    if a.partner == j and c.partner == i and a.contact == time and c.contact == time:
        return 1 if b.me < neighbour else 0
    return 2 if load(b.times, clock_word(neighbour)) == time else 0


@inline
def may_pass_all(state, i, time, where, b):
    """The same of all neighbours that matter: 0, 1 or 2."""
    low = high = 1
    if b.below >= 0 and where & (LOW | FOREIGN):
        low = may_pass(state, i, time, b.under, b)
    if b.above >= 0 and where & (HIGH | FOREIGN):
        high = may_pass(state, i, time, b.over, b)
    return 2 if low == 2 or high == 2 else min(low, high)


@inline
def least_clock(b):
    """Least clock of the neighbours."""
    least = np.inf
    if b.below >= 0:
        least = min(least, load(b.times, clock_word(b.under)))
    if b.above >= 0:
        least = min(least, load(b.times, clock_word(b.over)))
    return least


@inline
def is_in_order(record, ids, state, i, time, where, b):
    """Whether nothing has happened yet that had to wait for disc i's event; notes that it happens now."""
    own = b.own[0]
    if not where & (LOW | HIGH):
        if time <= own.late_inside or time <= own.late_at_border:
            return False
        own.inside = max(own.inside, time)
        return True
    if time <= own.late_inside and depth_of(record, ids, state, i, where, b) > DEEPEST:
        return False
    for side in (LOW, HIGH):
        if where & side:
            word = lock_word(b, b.below if side == LOW else b.above) + 1
            latest = b.times[U(word)]
            if time < latest or (time == latest and time != (own.low if side == LOW else own.high)):
                return False
            b.times[U(word)] = time
    if where & LOW:
        own.low = time
    if where & HIGH:
        own.high = time
    own.at_border = max(own.at_border, time)
    return True


@inline
def clock_runs(time, b):
    """Whether this thread's time goes on as it should; notes the event."""
    own = b.own[0]
    if time <= own.last:
        own.at_once += 1
        return time == own.last and own.at_once < MOST_AT_ONCE
    own.at_once = 0
    own.last = time
    return True


@inline
def loiter(b):
    """Lose time at random, where a test asks for that."""
    if b.delay > 0:
        own = b.own[0]
        own.draw = own.draw * np.uint64(6364136223846793005) + np.uint64(1442695040888963407)
        if np.int64(own.draw >> np.uint64(33)) % b.delay == 0:
            for _ in range(1000):
                pause()


@inline
def may_happen(record, ids, state, i, time, b):
    """Whether disc i's event, which comes next in this strip, may happen now: 1, or 0, or ABANDONED.

    If it may, the borders at which it is are locked.
    """
    own = b.own[0]
    where = 0
    if is_at_border(record, ids, state, i, b):
        where = place_of(record, ids, state, i, b)
        store(b.words, clock_word(b.me) + 2, i)
        store(b.times, clock_word(b.me) + 1, time)
        announce(b, time)
        if may_pass_all(state, i, time, where, b) == 0 or not try_lock(b, where):
            return 0
        passes = 0 if is_posted(b) or place_of(record, ids, state, i, b) != where else 1
        if passes == 1:
            passes = may_pass_all(state, i, time, where, b)
        if passes == 2:
            return abandon(b, TIE)
        if passes == 0:
            unlock(b)
            return 0
        if where & FOREIGN and is_misplaced(record, state, i, where, b):
            return abandon(b, VIOLATION)
    else:
        announce(b, time)
        if time > own.horizon:
            own.horizon = least_clock(b) + b.lead
            if time > own.horizon:
                return 0
    if not clock_runs(time, b):
        return abandon(b, CLOCK)
    if not is_in_order(record, ids, state, i, time, where, b):
        return abandon(b, VIOLATION)
    return 1


@inline
def wait_for_turn(record, ids, state, until, b):
    """Index of the disc with this strip's next event once it may happen, or OVER or ABANDONED."""
    own = b.own[0]
    unlock(b)
    loiter(b)
    rounds = 0
    while load(b.words, FLAG) == 0:
        if is_posted(b):
            absorb(ids, state, until, b)
        time = next_time(state.tree)
        if time <= until:
            i = next_disc(state.tree)
            turn = may_happen(record, ids, state, i, time, b)
            if turn != 0:
                return i if turn == 1 else np.int64(ABANDONED)
        else:
            announce(b, time)
            if not own.idle:
                own.idle = 1
                add(b.words, ACTIVE, np.int64(-1))
            if load(b.words, ACTIVE) == 0:
                return np.int64(OVER)
        rounds = wait(rounds)
    return np.int64(ABANDONED)
