"""The arrays the engines work on: one 64-byte record a disc, in an order of memory that is not the order of ids."""

from typing import NamedTuple

import numpy as np

from idealgas._jit import aligned, inline, njit
from idealgas.gas.state import Gas
from idealgas.physics.constants import NEVER
from idealgas.physics.motion import advance
from idealgas.physics.periodic import wrap

DISC = np.dtype(
    [
        ("x", "f8"), ("y", "f8"), ("vx", "f8"), ("vy", "f8"),
        ("t", "f8"),  # local time of the record, from the start of the epoch
        ("r", "f8"), ("m", "f8"),
        ("column", "i2"), ("row", "i2"),  # cell
        ("count", "u4"),  # events of this disc in this epoch
    ],
    align=True,
)  # fmt: skip

MOST_AT_ONCE = 100_000  # events a disc at one instant, far beyond what any pile-up of discs needs

COUNTERS = np.dtype(
    [
        ("events", "i8"), ("disc_collisions", "i8"), ("wall_hits", "i8"),
        ("crossings", "i8"), ("stale", "i8"), ("time", "f8"),  # local time of the last event
        ("events_at_this_time", "i8"),  # events since the clock last moved
        ("trials", "i8"), ("trial_time", "f8"),  # of Monte Carlo: since time 0; local time of the last one
    ]
)  # fmt: skip


class EventCascadeError(Exception):
    """A disc collides without end at one instant."""


class Limits(NamedTuple):
    """until: local time. events, collisions, trials: how many more of them."""

    until: float
    events: int
    collisions: int
    trials: int


class Discs(NamedTuple):
    """record: (N,) DISC. id: (N,) u4, the id of the disc at each place. box: (Lx, Ly)."""

    record: np.recarray
    id: np.ndarray
    box: tuple[float, float]


def make_discs(gas: Gas, order: np.ndarray) -> Discs:
    """Records at local time 0; `order` (N,) lists the ids in their order of memory."""
    record = aligned(len(gas), DISC)
    record.x, record.y = gas.position[order].T
    record.vx, record.vy = gas.velocity[order].T
    record.r, record.m = gas.radius[order], gas.mass[order]
    ids = aligned(len(gas), np.dtype("u4"))
    ids[:] = order
    return Discs(record, ids, gas.box)


@inline
def check_clock(time, now, events_at_this_time, n):
    """How many events in a row have happened at one instant.

    Raises StandingClock if it is to be without end, ValueError if time runs backwards.
    """
    if time < now:
        raise ValueError("time ran backwards")
    if time > now:
        return 0
    if events_at_this_time > MOST_AT_ONCE * n:
        raise EventCascadeError("the clock stands still: a disc collides without end at one instant")
    return events_at_this_time + 1


@inline
def add_to_counters(counter, events, disc_collisions, crossings, stale, now, events_at_this_time):
    """Count what happened in one call of a kernel; still: events since the clock last moved."""
    counter.events += events
    counter.disc_collisions += disc_collisions
    counter.wall_hits += events - disc_collisions
    counter.crossings += crossings
    counter.stale += stale
    counter.time = now
    counter.events_at_this_time = events_at_this_time


@njit
def synchronise(record, ids, time, gravity, periodic):
    """Bring every disc to one local time."""
    for i in range(record.shape[0]):
        advance(record[i], time, gravity)
        wrap(record[i], ids[i], periodic)


UNLIMITED = 1 << 62


LATEST = 0.25 * NEVER
