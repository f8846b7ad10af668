"""Subdomains of several threads: their clocks and locks, and the migration of discs between them.

The box is decomposed into slabs of rows of cells. A thread owns the discs whose cells lie in its slab, and schedules
their events. Events in the interior of a slab need no lock. A *halo event* is an event with a disc in one of the HALO
rows next to an interface of two slabs. It waits until the clock of the neighbour, which is the time of the neighbour's
next event, is later. Its thread then locks the interface; until it releases the lock, it may change a disc of the
neighbour in the first row beyond the interface, or let a disc migrate. A thread never changes the scheduler of another
thread: it sends the disc as a message, and the new owner schedules the disc and may have to set its clock back.
`synchronization` decides when an event may happen.
"""

from typing import NamedTuple

import numpy as np

from idealgas.engine.event_driven.scheduler import NO_TIE, remove, update
from idealgas.engine.parallel.atomics import LINE, add, exchange, load, store, wait
from idealgas.jit import inline, noinline

HALO = 4
"""Rows with halo events on each side of an interface. An event in row r reads r - 2 to r + 2, writes r - 1 to r + 1."""

SAFE_DEPTH = HALO - 3
"""Row, counted from the interface, up to which a halo event shares no row with events of the interior."""

MIN_ROWS = 2 * HALO + 3
"""Smallest number of rows of a slab: events at one of its interfaces are then out of reach of the other interface."""

LOW, HIGH, FOREIGN = 1, 2, 4
"""Location of a halo event: at the lower interface, at the upper one, or with a partner owned by another thread."""

DONE, ABORTED = -1, -2
"""Returned instead of the index of a disc: no events are left up to the limit, or the slice is aborted."""

VIOLATION, TIE, FULL, CLOCK, FAILED = range(1, 6)
"""Reasons why a slice is aborted: causality is violated, events at an interface are simultaneous, a limit is reached, a
clock stands still or runs backwards, or an error occurred."""

MAX_SIMULTANEOUS = 10_000  # consecutive events of a slab at one instant, after which one thread repeats the slice

FLAG, ACTIVE = 0, LINE  # words: reason why the slice is aborted, or 0; number of threads with events left
FIRST_LINE = 2  # lines before those of the slabs, each of which holds a clock, and the time and disc of a halo event
BEFORE_ALL = -1.0  # a time before all events

U = np.uintp

PRIVATE = np.dtype(
    [
        ("clock", "f8"), ("horizon", "f8"),  # published time; time up to which the neighbours' clocks need no check
        ("interior", "f8"), ("halo", "f8"),  # latest interior event; latest halo event
        ("message_interior", "f8"), ("message_halo", "f8"),  # `interior` and `halo` when the last message was received
        ("low", "f8"), ("high", "f8"),  # latest event at each interface since the last message
        ("last", "f8"),  # last event since the last message
        ("row_time", "f8"), ("unchecked", "i8"),  # latest event with rows; events still to check after a message
        ("simultaneous", "i8"),  # consecutive events at the time of the last one
        ("locked", "i8"), ("idle", "i8"),  # interfaces that are locked; whether no event is left up to the limit
        ("migrations", "i8"), ("clock_resets", "i8"), ("crossed_messages", "i8"),  # statistics
    ],
    align=True,
)  # fmt: skip


class Subdomain(NamedTuple):
    """A slab as its thread sees it, and the memory that all threads share.

    Attributes:
        rank: number of the slab.
        slabs: number of slabs.
        low: first row of the slab.
        high: row after the last row of the slab.
        interior: first row outside the halos, and the row after the last row outside them.
        below: number of the lower interface; -1 at a side of the box.
        above: number of the upper interface; -1 at a side of the box.
        rank_below: number of the slab below.
        rank_above: number of the slab above.
        lead: time by which interior events may be ahead of the neighbours' clocks; this limit makes violations rare.
        private: (1,) PRIVATE, used by this thread only.
        words: i8, shared by all threads: FLAG, ACTIVE, then the lines of slabs, of interfaces and of messages.
        times: f8, the same memory as `words`.
    """

    rank: int
    slabs: int
    low: int
    high: int
    interior: tuple[int, int]
    below: int
    above: int
    rank_below: int
    rank_above: int
    lead: float
    private: np.ndarray
    words: np.ndarray
    times: np.ndarray


def lines(slabs: int) -> int:
    """Number of cache lines that the threads share; slabs: number of slabs."""
    return FIRST_LINE + 4 * slabs


@inline
def clock_word(rank):
    """Index of the word with a slab's clock; the next two words are the time and the disc of its halo event."""
    return (FIRST_LINE + rank) * LINE


@inline
def lock_word(sub, interface):
    """Index of the word with an interface's lock; the next word is the time of the latest event there."""
    return (FIRST_LINE + sub.slabs + interface) * LINE


@inline
def message_word(sub, interface, up):
    """Index of the word with the disc that migrates across an interface, or -1; up: 1 if upwards, 0 if downwards."""
    return (FIRST_LINE + 2 * sub.slabs + 2 * interface + up) * LINE


@inline
def abort(sub, why):
    """Raise the flag unless it is already raised, and return ABORTED."""
    if load(sub.words, FLAG) == 0:
        store(sub.words, FLAG, np.int64(why))
    return ABORTED


@inline
def publish_clock(sub, time):
    """Set this slab's clock."""
    private = sub.private[0]
    if private.clock != time:
        private.clock = time
        store(sub.times, clock_word(sub.rank), time)


@inline
def has_message(sub):
    """Whether a neighbour is waiting for this thread to receive a disc."""
    is_waiting = False
    if sub.below >= 0:
        is_waiting |= load(sub.words, message_word(sub, sub.below, 1)) >= 0
    if sub.above >= 0:
        is_waiting |= load(sub.words, message_word(sub, sub.above, 0)) >= 0
    return is_waiting


@noinline
def receive(ids, state, until, sub):
    """Schedule the discs that neighbours have sent; the clock is set back before the neighbours continue."""
    private = sub.private[0]
    for up in range(2):
        interface = sub.below if up else sub.above
        word = message_word(sub, interface, up)
        if interface < 0 or load(sub.words, word) < 0:
            continue
        i = load(sub.words, word)
        state.tree.tie_time[0] = NO_TIE  # time may be set back
        update(state.tree, state.prediction, ids, i)
        time = state.tree.time[U(i)]
        private.message_interior = private.interior
        private.message_halo = private.halo
        private.low = private.high = private.last = BEFORE_ALL
        private.unchecked = 2  # the message may arrive during an event whose rows have not been checked yet
        if private.idle and time <= until:
            private.idle = 0
            add(sub.words, ACTIVE, np.int64(1))
        private.clock_resets += time < private.interior
        if time < private.clock:
            publish_clock(sub, time)
        store(sub.words, word, np.int64(-1))


@noinline
def migrate(ids, state, i, sub):
    """Send disc i to the neighbour beyond the locked interface, and wait until the neighbour has received it."""
    private = sub.private[0]
    remove(state.tree, state.prediction, ids, i)
    private.migrations += 1
    word = message_word(sub, sub.below, 0) if private.locked == LOW else message_word(sub, sub.above, 1)
    if private.locked != LOW and private.locked != HIGH:
        abort(sub, VIOLATION)
        return
    store(sub.words, word, np.int64(i))
    rounds = 0
    while load(sub.words, word) >= 0 and load(sub.words, FLAG) == 0:
        if has_message(sub):
            private.crossed_messages += 1
            receive(ids, state, -np.inf, sub)
        rounds = wait(rounds)


@inline
def unlock(sub):
    """Release the interfaces that the last halo event locked."""
    private = sub.private[0]
    if private.locked != 0:
        if private.locked & LOW:
            store(sub.words, lock_word(sub, sub.below), np.int64(0))
        if private.locked & HIGH:
            store(sub.words, lock_word(sub, sub.above), np.int64(0))
        private.locked = 0


@inline
def try_lock(sub, where):
    """Lock the interfaces of a halo event and return True; lock none and return False if another thread holds one."""
    if where & LOW and exchange(sub.words, lock_word(sub, sub.below), np.int64(1)) != 0:
        return False
    sub.private[0].locked = where & LOW
    if where & HIGH and exchange(sub.words, lock_word(sub, sub.above), np.int64(1)) != 0:
        unlock(sub)
        return False
    sub.private[0].locked = where & (LOW | HIGH)
    return True
