"""The brute-force method in numbers of any length, for smooth elastic discs in a reflecting box.

The laws and the rule for ties are those of `brute_force`, written in the arithmetic of `physics.arithmetic` and
compiled for each type of number. All pairs are asked for the next event; as an answer follows from the two records
alone, it is asked for anew only when one of them has changed. Local times count from the start of the run: one epoch is
all.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas._jit import inline, njit
from idealgas.engine.audit import deepest_overlap_of_all
from idealgas.engine.records import Limits, add_to_counters, check_clock, make_discs
from idealgas.engine.rows import batch_capacity, write_pair, write_side_hit
from idealgas.events import EventBatch
from idealgas.gas.state import Gas
from idealgas.physics.arithmetic import add, divide, less, load, multiply, number, root, rounded, store, subtract
from idealgas.physics.effects import Effects

NOBODY = -5  # beyond the sides, which are -1 to -4


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
def position_at(c, i, time):
    """Where disc i is at a time not before its record's."""
    dt = subtract(time, load(c.t, i))
    return (
        add(load(c.x, i), multiply(load(c.vx, i), dt)),
        add(load(c.y, i), multiply(load(c.vy, i), dt)),
    )


@inline
def relative_motion(c, i, j):
    """As `disc_disc.relative_motion`."""
    i_time, j_time = load(c.t, i), load(c.t, j)
    time = i_time if less(j_time, i_time) else j_time
    i_dt, j_dt = subtract(time, i_time), subtract(time, j_time)
    i_vx, i_vy, j_vx, j_vy = load(c.vx, i), load(c.vy, i), load(c.vx, j), load(c.vy, j)
    x = subtract(load(c.x, i), load(c.x, j))
    y = subtract(load(c.y, i), load(c.y, j))
    x = add(x, subtract(multiply(i_vx, i_dt), multiply(j_vx, j_dt)))
    y = add(y, subtract(multiply(i_vy, i_dt), multiply(j_vy, j_dt)))
    return time, x, y, subtract(i_vx, j_vx), subtract(i_vy, j_vy)


@inline
def dot(ax, ay, bx, by):
    """Scalar product."""
    return add(multiply(ax, bx), multiply(ay, by))


@inline
def velocities_after(c, i, j, x, y, vx, vy):
    """Of discs i and j after they met with this relative motion."""
    i_mass, j_mass = load(c.m, i), load(c.m, j)
    impulse = multiply(number(2.0, x), dot(x, y, vx, vy))
    k = divide(impulse, multiply(dot(x, y, x, y), add(i_mass, j_mass)))
    i_k, j_k = multiply(k, j_mass), multiply(k, i_mass)
    return (
        subtract(load(c.vx, i), multiply(i_k, x)),
        subtract(load(c.vy, i), multiply(i_k, y)),
        add(load(c.vx, j), multiply(j_k, x)),
        add(load(c.vy, j), multiply(j_k, y)),
    )


@inline
def pair_time(c, i, j):
    """As `disc_disc.contact_time`; infinite if there is none."""
    time, x, y, vx, vy = relative_motion(c, i, j)
    never, zero = number(math.inf, time), number(0.0, time)
    approach = dot(x, y, vx, vy)
    if not less(approach, zero):
        return never
    reach = add(load(c.r, i), load(c.r, j))
    square = multiply(reach, reach)
    gap = subtract(dot(x, y, x, y), square)
    touch = time
    if less(zero, gap):
        cross = subtract(multiply(vx, y), multiply(vy, x))
        discriminant = subtract(multiply(dot(vx, vy, vx, vy), square), multiply(cross, cross))
        if not less(zero, discriminant):
            return never
        touch = add(time, divide(gap, subtract(root(discriminant), approach)))
    if not less(time, touch):
        before = load(c.vx, i), load(c.vy, i), load(c.vx, j), load(c.vy, j)
        if velocities_after(c, i, j, x, y, vx, vy) == before:
            return never
    return touch


@inline
def side_time(c, i, side):
    """As `box_side.side_contact`; infinite if there is none."""
    if side < 2:
        position, velocity = load(c.x, i), load(c.vx, i)
    else:
        position, velocity = load(c.y, i), load(c.vy, i)
    zero = number(0.0, position)
    upper = side & 1
    if not (less(zero, velocity) if upper else less(velocity, zero)):
        return number(math.inf, position)
    radius = load(c.r, i)
    target = subtract(load(c.box, side >> 1), radius) if upper else radius
    delay = divide(subtract(target, position), velocity)
    return add(load(c.t, i), zero if less(delay, zero) else delay)


@inline
def find_next(c, coming, i):
    """Ask all sides and discs for the next event of disc i, walls first, then by id."""
    best = number(math.inf, load(c.t, i))
    partner = NOBODY
    for side in range(4):
        time = side_time(c, i, side)
        if less(time, best):
            best, partner = time, -1 - side
    for j in range(c.t.shape[0]):
        if j != i:
            time = pair_time(c, i, j)
            if less(time, best):
                best, partner = time, j
    store(coming.time, i, best)
    coming.partner[i] = partner


@inline
def offer(c, coming, i, j):
    """Disc j has a new record: whether it meets disc i before all others."""
    time, best = pair_time(c, i, j), load(coming.time, i)
    if less(time, best) or (j < coming.partner[i] and not less(best, time)):
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
    x, y = position_at(c, i, time)
    store(c.x, i, x)
    store(c.y, i, y)
    store(c.t, i, time)


@inline
def resolve_side(c, i, side, time):
    """Disc i meets a side of the box."""
    move(c, i, time)
    velocity = c.vx if side < 2 else c.vy
    speed = load(velocity, i)
    store(velocity, i, subtract(number(0.0, speed), speed))


@inline
def resolve_pair(c, i, j, time):
    """Discs i and j meet."""
    move(c, i, time)
    move(c, j, time)
    _, x, y, vx, vy = relative_motion(c, i, j)
    i_vx, i_vy, j_vx, j_vy = velocities_after(c, i, j, x, y, vx, vy)
    store(c.vx, i, i_vx)
    store(c.vy, i, i_vy)
    store(c.vx, j, j_vx)
    store(c.vy, j, j_vy)


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
            if less(load(coming.time, k), time):
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
    zero = number(0.0, end)
    for i in range(c.t.shape[0]):
        move(c, i, end)
        store(c.vx, i, subtract(zero, load(c.vx, i)))
        store(c.vy, i, subtract(zero, load(c.vy, i)))
        store(c.t, i, zero)


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
