"""Where the strips of several threads meet: clocks, locks, and how a disc comes to the thread that has it.

A thread owns the discs whose cells lie in its strip of rows, and a schedule of theirs. Events that are far from the
borders go on at once. A *border* event, with a disc in one of the ZONE rows at a border, waits until the neighbour's
clock, the time of its next event, is later; then it takes the border's lock, under which it may change the neighbour's
disc in the first row beyond, and hand a disc over. Nobody touches another's schedule: a disc is posted, and the owner
enters it, which may set its clock back. `turns` says whose turn it is.
"""

from typing import NamedTuple

import numpy as np

from idealgas.engine.event_driven.scheduler import NO_TIE, remove, update
from idealgas.engine.parallel.atomics import LINE, add, exchange, load, store, wait
from idealgas.jit import inline, noinline

ZONE = 4
"""Rows at a border whose events are border events. An event at r reads the rows r - 2 to r + 2, and writes the next."""

DEEPEST = ZONE - 3
"""Row, counted from the border, up to which a border event has nothing in common with those outside the zone."""

LEAST_ROWS = 2 * ZONE + 3
"""Rows of a strip: what happens at one of its borders is then out of reach of the other."""

LOW, HIGH, FOREIGN = 1, 2, 4
"""Where an event is: at the border below, at that above, or with a partner that belongs to another thread."""

OVER, ABANDONED = -1, -2
"""Instead of the index of a disc: there are no more events up to the limit, or the work is given up."""

VIOLATION, TIE, FULL, CLOCK, FAILED = range(1, 6)
"""Why work is given up: a changed past, events of one time at a border, limits too narrow, a clock that stands still or
runs backwards, an error."""

MOST_AT_ONCE = 10_000  # events of a strip at one instant; where there are more, one thread finds out how many

FLAG, ACTIVE = 0, LINE  # words: why work is given up, or 0; number of threads that have events
FIRST = 2  # lines before those of the strips: clock, time of its border event and whose it is
LATE = -1.0  # before all times

U = np.uintp

OWN = np.dtype(
    [
        ("clock", "f8"), ("horizon", "f8"),  # as announced; up to which the neighbours' clocks need no look
        ("inside", "f8"), ("at_border", "f8"),  # latest event far from borders; latest one at a border
        ("late_inside", "f8"), ("late_at_border", "f8"),  # the same when a disc was posted last
        ("low", "f8"), ("high", "f8"),  # latest event at each border, if no disc was posted since
        ("last", "f8"),  # last event, if no disc was posted since
        ("row_time", "f8"), ("posted", "i8"),  # latest event with rows; how many such may follow a disc that was posted
        ("at_once", "i8"),  # events in a row at that time
        ("held", "i8"), ("idle", "i8"),  # borders that are locked; whether there is no event up to the limit
        ("draw", "u8"),  # state of the delays
        ("posts", "i8"), ("set_back", "i8"), ("while_posting", "i8"),  # facts
    ],
    align=True,
)  # fmt: skip


class Border(NamedTuple):
    """What a thread needs to know of its strip and the others.

    Attributes:
        me: number of the strip.
        strips: number of strips.
        low: first row of the strip.
        high: row after its last.
        inside: first row in no border's zone, and the row after the last such.
        below: number of the border below; -1 where the strip ends at a side of the box.
        above: number of the border above, or -1.
        under: number of the strip below.
        over: number of the strip above.
        lead: how far events inside may be ahead of the neighbours' clocks, time; it makes violations rare.
        delay: one event in so many waits for long, for tests; 0 for none.
        own: (1,) OWN, what only this thread uses.
        words: i8, what all share: FLAG, ACTIVE, then the lines of the strips, of the borders, and of what is posted.
        times: f8, the same memory.
    """

    me: int
    strips: int
    low: int
    high: int
    inside: tuple[int, int]
    below: int
    above: int
    under: int
    over: int
    lead: float
    delay: int
    own: np.ndarray
    words: np.ndarray
    times: np.ndarray


def lines(strips: int) -> int:
    """Number of cache lines that the threads share."""
    return FIRST + 4 * strips


@inline
def clock_word(strip):
    """Index of a strip's clock; the two words after it are the time of its border event and its disc."""
    return (FIRST + strip) * LINE


@inline
def lock_word(b, border):
    """Index of a border's lock; the word after it is the time of the latest event there."""
    return (FIRST + b.strips + border) * LINE


@inline
def mail_word(b, border, up):
    """Index of the word with the disc that is posted across a border, or -1. up: 1 if upwards, 0 if downwards."""
    return (FIRST + 2 * b.strips + 2 * border + up) * LINE


@inline
def abandon(b, why):
    """Raise the flag, unless it is raised, and return ABANDONED."""
    if load(b.words, FLAG) == 0:
        store(b.words, FLAG, np.int64(why))
    return ABANDONED


@inline
def announce(b, time):
    """Set this strip's clock."""
    own = b.own[0]
    if own.clock != time:
        own.clock = time
        store(b.times, clock_word(b.me), time)


@inline
def is_posted(b):
    """Whether a neighbour waits for this thread to enter a disc."""
    found = False
    if b.below >= 0:
        found |= load(b.words, mail_word(b, b.below, 1)) >= 0
    if b.above >= 0:
        found |= load(b.words, mail_word(b, b.above, 0)) >= 0
    return found


@noinline
def absorb(ids, state, until, b):
    """Enter what neighbours have posted; the clock is set back before they go on."""
    own = b.own[0]
    for up in range(2):
        border = b.below if up else b.above
        word = mail_word(b, border, up)
        if border < 0 or load(b.words, word) < 0:
            continue
        i = load(b.words, word)
        state.tree.tie_time[0] = NO_TIE  # time may go back
        update(state.tree, state.prediction, ids, i)
        time = state.tree.time[U(i)]
        own.late_inside = own.inside
        own.late_at_border = own.at_border
        own.low = own.high = own.last = LATE
        own.posted = 2  # maybe within an event whose rows are still to be noted
        if own.idle and time <= until:
            own.idle = 0
            add(b.words, ACTIVE, np.int64(1))
        own.set_back += time < own.inside
        if time < own.clock:
            announce(b, time)
        store(b.words, word, np.int64(-1))


@noinline
def hand_over(ids, state, i, b):
    """Post disc i to the neighbour beyond the border that is held, and wait until it is in that schedule."""
    own = b.own[0]
    remove(state.tree, state.prediction, ids, i)
    own.posts += 1
    word = mail_word(b, b.below, 0) if own.held == LOW else mail_word(b, b.above, 1)
    if own.held != LOW and own.held != HIGH:
        abandon(b, VIOLATION)
        return
    store(b.words, word, np.int64(i))
    rounds = 0
    while load(b.words, word) >= 0 and load(b.words, FLAG) == 0:
        if is_posted(b):
            own.while_posting += 1
            absorb(ids, state, -np.inf, b)
        rounds = wait(rounds)


@inline
def unlock(b):
    """Leave the border event that happened last, if there was one."""
    own = b.own[0]
    if own.held != 0:
        if own.held & LOW:
            store(b.words, lock_word(b, b.below), np.int64(0))
        if own.held & HIGH:
            store(b.words, lock_word(b, b.above), np.int64(0))
        own.held = 0


@inline
def try_lock(b, where):
    """Lock the borders at which an event is; False, and none of them, if another thread has one."""
    if where & LOW and exchange(b.words, lock_word(b, b.below), np.int64(1)) != 0:
        return False
    b.own[0].held = where & LOW
    if where & HIGH and exchange(b.words, lock_word(b, b.above), np.int64(1)) != 0:
        unlock(b)
        return False
    b.own[0].held = where & (LOW | HIGH)
    return True
