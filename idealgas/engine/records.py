"""Arrays of the engines: a 64-byte record of the state of each disc, in an order that may differ from that of ids."""

from typing import NamedTuple

import numpy as np

from idealgas.jit import aligned, inline, njit
from idealgas.physics.absorbing import has_left
from idealgas.physics.motion import NEVER, advance
from idealgas.physics.periodic import wrap
from idealgas.physics.stress import complete_flights
from idealgas.state import Gas

DISC = np.dtype(
    [
        ("x", "f8"), ("y", "f8"), ("vx", "f8"), ("vy", "f8"),  # position, length; velocity, length/time
        ("t", "f8"),  # local time of the record, from the start of the epoch
        ("r", "f8"), ("m", "f8"),  # radius, length; mass
        ("crossed_x", "i2"), ("crossed_y", "i2"),  # boundary crossings since that time (see `periodic`)
        ("count", "u4"),  # events of this disc in this epoch
    ],
    align=True,
)  # fmt: skip

U = np.uintp

MOST_AT_ONCE = 100_000  # events per disc at the same instant: far more than touching discs ever need

COUNTERS = np.dtype(
    [
        ("events", "i8"), ("disc_collisions", "i8"), ("wall_hits", "i8"),  # in this epoch
        ("thermostat_collisions", "i8"),
        ("time", "f8"),  # local time of the last event
        ("events_at_this_time", "i8"),  # number of consecutive events at that time
        ("trials", "i8"), ("trial_time", "f8"),  # Monte Carlo trials since time 0; local time of the last trial
    ]
)  # fmt: skip


class InelasticCollapseError(Exception):
    """A disc collides endlessly at one instant."""


class Discs(NamedTuple):
    """Records of the discs in memory order.

    Attributes:
        record: (N,) DISC by index.
        id: (N,) u4, id of the disc at each index.
        box: (Lx, Ly), length.
    """

    record: np.recarray
    id: np.ndarray
    box: tuple[float, float]


def make_discs(gas: Gas, order: np.ndarray) -> Discs:
    """Make the records of a gas at local time 0; order: (N,) ids in memory order."""
    record = aligned(len(gas), DISC)
    fields = record.view(np.ndarray)  # access to the fields of a record array is far slower
    columns = (*gas.position.T, *gas.velocity.T, gas.radius, gas.mass)
    for name, column in zip(("x", "y", "vx", "vy", "r", "m"), columns, strict=True):
        fields[name] = column[order]
    ids = aligned(len(gas), np.dtype("u4"))
    ids[:] = order
    return Discs(record, ids, gas.box)


@inline
def check_clock(time, now, events_at_this_time, n):
    """Return the number of consecutive events at one instant, when an event at `time` follows an event at `now`.

    Both times are local. n: number of discs. Raises InelasticCollapseError if there are so many events at one instant
    that they seem endless, and ValueError if time runs backwards.
    """
    if time < now:
        raise ValueError("time ran backwards")
    if time > now:
        return 0
    if events_at_this_time > MOST_AT_ONCE * n:
        raise InelasticCollapseError("the clock stands still: a disc collides without end at one instant")
    return events_at_this_time + 1


@inline
def add_to_counters(counter, events, disc_collisions, thermostat_collisions, now, events_at_this_time):
    """Add the events of a kernel call to the counters; all events of other kinds are wall hits.

    now: local time of the last event. events_at_this_time: number of consecutive events at that time.
    """
    counter.events += events
    counter.disc_collisions += disc_collisions
    counter.wall_hits += events - disc_collisions - thermostat_collisions
    counter.thermostat_collisions += thermostat_collisions
    counter.time = now
    counter.events_at_this_time = events_at_this_time


@njit
def synchronise(discs, time, gravity, periodic, flow, absorbing, position, velocity):
    """Move every disc to a local time, wrap its position into the box, and store position and velocity by id.

    If the momentum flow is recorded, it is completed up to that time. position, velocity: (N, 2) f8, length and
    length/time.
    """
    record, ids, _ = discs
    if flow is not None:
        complete_flights(record, time, gravity, flow, absorbing)
    for i in range(record.shape[0]):
        disc = record[U(i)]
        disc_id = U(ids[U(i)])
        if absorbing is None or not has_left(disc, absorbing):
            advance(disc, time, gravity)
            if periodic is not None:
                wrap(disc, disc_id, periodic)
        position[disc_id, 0], position[disc_id, 1] = disc.x, disc.y
        velocity[disc_id, 0], velocity[disc_id, 1] = disc.vx, disc.vy


UNLIMITED = 1 << 62  # number of events that stands for no limit
LATEST = 0.25 * NEVER  # time that stands for no limit
