"""The brute-force method in multiprecision arithmetic, for smooth elastic discs in a reflecting box.

The laws of motion and collision are the same as in the other methods, compiled for each number type of
`physics.arithmetic`. Simultaneous events are ordered as in `brute_force`. All pairs are searched for the next event;
because the time of a contact depends only on the states of its two discs, it is computed again only when one of these
has changed. Local times count from the start of the run, which is a single epoch.
"""

from collections import namedtuple
from typing import NamedTuple

import numpy as np

from idealgas.columns import EventBatch
from idealgas.effects.bundle import Effects
from idealgas.engine.event_writer import WALL, batch_capacity, write_hit, write_pair
from idealgas.engine.method import Limits, Method
from idealgas.engine.records import add_to_counters, check_clock
from idealgas.jit import inline, njit
from idealgas.physics.arithmetic import load, number, rounded, store
from idealgas.physics.disc_disc import contact_time, velocities_after
from idealgas.physics.disc_wall import side_contact
from idealgas.physics.motion import NEVER, position_after
from idealgas.physics.periodic import NO_IMAGES
from idealgas.state import Gas

NO_PARTNER = -5  # the sides are -1 to -4
ELASTIC = 2.0  # 1 + the coefficient of restitution
PLAIN = Effects()


Disc = namedtuple("Disc", "x y vx vy t r m")
"""A disc, with the fields of `DISC` as numbers of a single type."""


class Columns(NamedTuple):
    """All discs in order of id, and the size of the box.

    Each column is (N,) f4 or f8, or (N, 2) f8 for double-double numbers.
    """

    x: np.ndarray
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray
    t: np.ndarray
    r: np.ndarray
    m: np.ndarray
    box: np.ndarray


class Next(NamedTuple):
    """The next event of each disc.

    Attributes:
        time: column of local times.
        partner: (N,) i4, id of the partner, -1 - k for side k, or NO_PARTNER.
    """

    time: np.ndarray
    partner: np.ndarray


def column_of(values: np.ndarray, precision: str) -> np.ndarray:
    """Convert floats (n,) to a column of the precision "float32", "float64" or "double-double"."""
    if precision == "float32":
        return np.array(values, np.float32)
    if precision == "float64":
        return np.array(values, float)
    return np.column_stack((values, np.zeros(len(values))))


def make_columns(gas: Gas, precision: str) -> Columns:
    """Make the columns of the discs of a gas at local time 0; precision: as in `column_of`."""
    arrays = (*gas.position.T, *gas.velocity.T, np.zeros(len(gas)), gas.radius, gas.mass, np.array(gas.box))
    return Columns(*(column_of(values, precision) for values in arrays))


@inline
def disc_at(c, i):
    """Disc i of the columns."""
    return Disc(load(c.x, i), load(c.y, i), load(c.vx, i), load(c.vy, i), load(c.t, i), load(c.r, i), load(c.m, i))


@inline
def pair_time(c, i, j):
    """Local time of the next collision of discs i and j; NEVER if there is none."""
    return contact_time(disc_at(c, i), disc_at(c, j), i, j, NO_IMAGES, None, None, PLAIN)


@inline
def find_next(c, upcoming, i):
    """Find and store the next event of disc i; of simultaneous events, sides come first, then discs in order of id."""
    best = number(NEVER, load(c.t, i))
    partner = NO_PARTNER
    for side in range(4):
        time = side_contact(disc_at(c, i), side, load(c.box, side >> 1), None)
        if time < best:
            best, partner = time, -1 - side
    for j in range(c.t.shape[0]):
        if j != i:
            time = pair_time(c, i, j)
            if time < best:
                best, partner = time, j
    store(upcoming.time, i, best)
    upcoming.partner[i] = partner


@inline
def offer(c, upcoming, i, j):
    """Store the contact of disc i with disc j, whose state has changed, if it is the next event of disc i."""
    time, best = pair_time(c, i, j), load(upcoming.time, i)
    if time < best or (j < upcoming.partner[i] and time <= best):
        store(upcoming.time, i, time)
        upcoming.partner[i] = j


@njit
def find_all(c, upcoming):
    """Find and store the next event of every disc."""
    for i in range(c.t.shape[0]):
        find_next(c, upcoming, i)


@inline
def find_again(c, upcoming, i, j):
    """Update the next event of every disc after a collision of discs i and j, or of disc i and a side if j < 0."""
    for k in range(c.t.shape[0]):
        partner = upcoming.partner[k]
        if k in (i, j) or partner == i or (j >= 0 and partner == j):
            find_next(c, upcoming, k)
        else:
            offer(c, upcoming, k, i)
            if j >= 0:
                offer(c, upcoming, k, j)


@inline
def move(c, i, time):
    """Move disc i in free flight to a local time."""
    delay = time - load(c.t, i)
    store(c.x, i, position_after(load(c.x, i), load(c.vx, i), None, delay))
    store(c.y, i, position_after(load(c.y, i), load(c.vy, i), None, delay))
    store(c.t, i, time)


@inline
def reverse(velocity, i):
    """Reverse a component of disc i's velocity; velocity: column of this component."""
    speed = load(velocity, i)
    store(velocity, i, number(0.0, speed) - speed)


@inline
def resolve_side(c, i, side, time):
    """Move disc i to a local time and reflect it at a side of the box."""
    move(c, i, time)
    reverse(c.vx if side < 2 else c.vy, i)


@inline
def resolve_pair(c, i, j, time):
    """Move discs i and j to a local time and collide them."""
    move(c, i, time)
    move(c, j, time)
    a, b = disc_at(c, i), disc_at(c, j)
    a_vx, a_vy, b_vx, b_vy = velocities_after(a, b, a.x - b.x, a.y - b.y, a.vx - b.vx, a.vy - b.vy, ELASTIC)
    store(c.vx, i, a_vx)
    store(c.vy, i, a_vy)
    store(c.vx, j, b_vx)
    store(c.vy, j, b_vy)


@inline
def write_record(c, i, disc):
    """Round disc i's numbers to float64 and write them into its record."""
    disc.x = rounded(load(c.x, i))
    disc.y = rounded(load(c.y, i))
    disc.vx = rounded(load(c.vx, i))
    disc.vy = rounded(load(c.vy, i))
    disc.t = rounded(load(c.t, i))


@njit
def advance_precisely(c, upcoming, discs, effects, limits, epoch_start, batch, counters):
    """Process events up to the limits, or until the batch is full; discs are in order of id.

    Returns the number of rows written, and whether all events up to the time limit have happened. discs: the discs
    rounded to float64, which are updated.
    """
    record, ids, _ = discs
    rows = events = collisions = 0
    now = counters[0].time
    events_at_this_time = counters[0].events_at_this_time
    reached = False
    capacity = batch_capacity(batch)
    while events < limits.events and collisions < limits.collisions and rows < capacity:
        i = 0
        time = load(upcoming.time, 0)
        for k in range(1, record.shape[0]):
            if load(upcoming.time, k) < time:
                i, time = k, load(upcoming.time, k)
        clock = rounded(time)
        if clock > limits.until:
            reached = True
            break
        j = np.int64(upcoming.partner[i])
        if j >= 0:
            resolve_pair(c, i, j, time)
            write_record(c, i, record[i])
            write_record(c, j, record[j])
            rows += write_pair(batch, rows, epoch_start + clock, record, ids, i, j, effects)
            collisions += 1
        else:
            resolve_side(c, i, -1 - j, time)
            write_record(c, i, record[i])
            rows += write_hit(batch, rows, epoch_start + clock, i, j, WALL, record[i], effects)
        find_again(c, upcoming, i, j)
        events += 1
        events_at_this_time = check_clock(clock, now, events_at_this_time, record.shape[0])
        now = clock
    add_to_counters(counters[0], events, collisions, 0, now, events_at_this_time)
    return rows, reached


@njit
def turn_back(c, time):
    """Move all discs to a local time, reverse their velocities, and restart local times from 0 there."""
    end = number(time, load(c.t, 0))
    for i in range(c.t.shape[0]):
        move(c, i, end)
        reverse(c.vx, i)
        reverse(c.vy, i)
        store(c.t, i, number(0.0, end))


class PreciseBruteForce(Method):
    """The brute-force method in multiprecision arithmetic.

    Attributes:
        columns: the discs in full precision.
    """

    single_epoch = True

    def __init__(self, precision: str, start: Columns | None = None) -> None:
        """Set the precision: "float32", "float64" or "double-double".

        start: the discs at the start of the run, if their precision is higher than a gas can store.
        """
        self._precision, self._start = precision, start

    def start(self, gas: Gas, effects: Effects) -> None:
        """Begin the run's only epoch."""
        super().start(gas, effects)
        start = self._start or make_columns(gas, self._precision)
        self.columns = Columns(*(column.copy() for column in start))
        self._upcoming = Next(np.empty_like(start.t), np.empty(len(gas), np.int32))
        find_all(self.columns, self._upcoming)

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Process events; see `advance_precisely`."""
        return advance_precisely(
            self.columns, self._upcoming, self.discs, self._effects, limits, epoch_start, batch, counters
        )
