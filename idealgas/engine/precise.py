"""The brute-force method in numbers of any length, for smooth elastic discs in a reflecting box.

The laws are those of every method, compiled for each type of number of `physics.arithmetic`; the rule for ties is that
of `brute_force`. All pairs are asked for the next event; as an answer follows from the two records
alone, it is asked for anew only when one of them has changed. Local times count from the start of the run: one epoch is
all.
"""

from typing import Any, NamedTuple

import numpy as np

from idealgas._jit import inline, njit
from idealgas.engine.audit import deepest_overlap_of_all
from idealgas.engine.records import Limits, add_to_counters, check_clock, make_discs
from idealgas.engine.rows import batch_capacity, write_pair, write_side_hit
from idealgas.events import EventBatch
from idealgas.gas.state import Gas
from idealgas.physics.arithmetic import load, number, rounded, store
from idealgas.physics.box_side import side_contact
from idealgas.physics.constants import NEVER
from idealgas.physics.disc_disc import contact_time, velocities_after
from idealgas.physics.effects import Effects
from idealgas.physics.motion import position_after
from idealgas.physics.periodic import NO_IMAGES

NOBODY = -5  # beyond the sides, which are -1 to -4
ELASTIC = 2.0  # 1 + the coefficient of restitution


class Columns(NamedTuple):
    """The discs, in order of id: (N,) f4 or f8, or (N, 2) f8 of pairs. box: the same with its two lengths."""

    x: np.ndarray
    y: np.ndarray
    vx: np.ndarray
    vy: np.ndarray
    t: np.ndarray
    r: np.ndarray
    m: np.ndarray
    box: np.ndarray


class Disc(NamedTuple):
    """One disc: position, velocity, time of the record, radius and mass, as numbers of one length."""

    x: Any
    y: Any
    vx: Any
    vy: Any
    t: Any
    r: Any
    m: Any


class Next(NamedTuple):
    """The next event of each disc. time: a column. partner: (N,) i4, another disc, -1 - k for side k, or NOBODY."""

    time: np.ndarray
    partner: np.ndarray


def column_of(values: np.ndarray, precision: str) -> np.ndarray:
    """Floats as a column of numbers."""
    if precision == "float32":
        return np.array(values, np.float32)
    if precision == "float64":
        return np.array(values, float)
    return np.column_stack((values, np.zeros(len(values))))


def make_columns(gas: Gas, precision: str) -> Columns:
    """The discs of a gas at local time 0."""
    arrays = (*gas.position.T, *gas.velocity.T, np.zeros(len(gas)), gas.radius, gas.mass, np.array(gas.box))
    return Columns(*(column_of(values, precision) for values in arrays))


@inline
def disc_at(c, i):
    """Disc i as the laws take it."""
    return Disc(load(c.x, i), load(c.y, i), load(c.vx, i), load(c.vy, i), load(c.t, i), load(c.r, i), load(c.m, i))


@inline
def pair_time(c, i, j):
    """Time of the next collision of discs i and j; NEVER if there is none."""
    return contact_time(disc_at(c, i), disc_at(c, j), i, j, None, None, None, NO_IMAGES)


@inline
def side_time(c, i, side):
    """Time at which disc i meets a side of the box; NEVER if it does not."""
    return side_contact(disc_at(c, i), side, load(c.box, side >> 1), None)


@inline
def find_next(c, coming, i):
    """Ask all sides and discs for the next event of disc i, walls first, then by id."""
    best = number(NEVER, load(c.t, i))
    partner = NOBODY
    for side in range(4):
        time = side_time(c, i, side)
        if time < best:
            best, partner = time, -1 - side
    for j in range(c.t.shape[0]):
        if j != i:
            time = pair_time(c, i, j)
            if time < best:
                best, partner = time, j
    store(coming.time, i, best)
    coming.partner[i] = partner


@inline
def offer(c, coming, i, j):
    """Disc j has a new record: whether it meets disc i before all others."""
    time, best = pair_time(c, i, j), load(coming.time, i)
    if time < best or (j < coming.partner[i] and time <= best):
        store(coming.time, i, time)
        coming.partner[i] = j


@njit
def find_all(c, coming):
    """The next event of every disc."""
    for i in range(c.t.shape[0]):
        find_next(c, coming, i)


@inline
def find_again(c, coming, i, j):
    """What has become of all next events after one of discs i and j; j < 0: of disc i and a side."""
    for k in range(c.t.shape[0]):
        partner = coming.partner[k]
        if k in (i, j) or partner == i or (j >= 0 and partner == j):
            find_next(c, coming, k)
        else:
            offer(c, coming, k, i)
            if j >= 0:
                offer(c, coming, k, j)


@inline
def move(c, i, time):
    """Bring disc i to a time."""
    delay = time - load(c.t, i)
    store(c.x, i, position_after(load(c.x, i), load(c.vx, i), None, delay))
    store(c.y, i, position_after(load(c.y, i), load(c.vy, i), None, delay))
    store(c.t, i, time)


@inline
def turn(velocity, i):
    """Reverse a component of disc i's velocity."""
    speed = load(velocity, i)
    store(velocity, i, number(0.0, speed) - speed)


@inline
def resolve_side(c, i, side, time):
    """Disc i meets a side of the box."""
    move(c, i, time)
    turn(c.vx if side < 2 else c.vy, i)


@inline
def resolve_pair(c, i, j, time):
    """Discs i and j meet."""
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
    """Round disc i to a record."""
    disc.x = rounded(load(c.x, i))
    disc.y = rounded(load(c.y, i))
    disc.vx = rounded(load(c.vx, i))
    disc.vy = rounded(load(c.vy, i))
    disc.t = rounded(load(c.t, i))


@njit
def advance_precisely(c, coming, record, ids, effects, limits, epoch_start, batch, counters):
    """As `brute_force.advance_events`; record: the discs rounded, kept so."""
    rows = 0
    events = 0
    collisions = 0
    now = counters[0].time
    events_at_this_time = counters[0].events_at_this_time
    reached = False
    capacity = batch_capacity(batch)
    while events < limits.events and collisions < limits.collisions and rows < capacity:
        i = 0
        time = load(coming.time, 0)
        for k in range(1, record.shape[0]):
            if load(coming.time, k) < time:
                i, time = k, load(coming.time, k)
        clock = rounded(time)
        if clock > limits.until:
            reached = True
            break
        j = np.int64(coming.partner[i])
        if j >= 0:
            resolve_pair(c, i, j, time)
            write_record(c, i, record[i])
            write_record(c, j, record[j])
            rows += write_pair(batch, rows, epoch_start + clock, record, ids, i, j, effects)
            collisions += 1
        else:
            resolve_side(c, i, -1 - j, time)
            write_record(c, i, record[i])
            rows += write_side_hit(batch, rows, epoch_start + clock, i, -1 - j, record[i], effects)
        find_again(c, coming, i, j)
        events += 1
        events_at_this_time = check_clock(clock, now, events_at_this_time, record.shape[0])
        now = clock
    add_to_counters(counters[0], events, collisions, 0, 0, now, events_at_this_time)
    return rows, reached


@njit
def turn_back(c, time):
    """Bring all discs to a local time, reverse their velocities and count time from there."""
    end = number(time, load(c.t, 0))
    for i in range(c.t.shape[0]):
        move(c, i, end)
        turn(c.vx, i)
        turn(c.vy, i)
        store(c.t, i, number(0.0, end))


class PreciseBruteForce:
    """The method as an object. columns: the discs as they are, with all their digits."""

    without_positions = False
    single_epoch = True

    def __init__(self, precision: str, start: Columns | None = None) -> None:
        """precision: "float32", "float64" or "double-double". start: the discs, if the gas has not all their digits."""
        self._precision, self._start = precision, start

    def start(self, gas: Gas, effects: Effects) -> None:
        """Begin."""
        self.discs = make_discs(gas, np.arange(len(gas)))
        start = self._start or make_columns(gas, self._precision)
        self.columns = Columns(*(column.copy() for column in start))
        self._coming = Next(np.empty_like(start.t), np.empty(len(gas), np.int32))
        self._effects = effects
        find_all(self.columns, self._coming)

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """See `advance_precisely`."""
        record, ids, _ = self.discs
        return advance_precisely(
            self.columns, self._coming, record, ids, self._effects, limits, epoch_start, batch, counters
        )

    def deepest_overlap(self) -> float:
        """Deepest overlap at the start; call it before `advance`."""
        return deepest_overlap_of_all(self.discs.record, None)
