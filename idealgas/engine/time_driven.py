"""The time-driven method: all discs fly for a step, then whatever overlaps or stands outside and comes nearer collides.

It is the rival of the event-driven method and wrong by its step: a contact is found late, half a step on the average,
with a turned line of centres; what lies between two steps is missed. As fast as such a method gets: near pairs are
listed once, by cells, and the list serves until two discs may have come `skin` nearer (Verlet, Phys. Rev. 159, 98
(1967); Allen & Tildesley, Computer Simulation of Liquids, 2nd ed. (2017), ch. 5.3).
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas._jit import inline, njit
from idealgas.engine.records import Limits, add_to_counters, make_discs
from idealgas.engine.resolve import resolve_pair, resolve_side
from idealgas.engine.rows import batch_capacity, write_pair, write_side_hit
from idealgas.events import EventBatch
from idealgas.gas.state import Gas
from idealgas.physics.effects import Effects
from idealgas.physics.motion import advance
from idealgas.physics.periodic import is_periodic, nearest_images, periodic_axes, separation, wrap

U = np.uintp
NEAR = 3.0  # mean number of discs within reach: that was fastest
LEAST_SKIN = 0.2  # diameters
CELLS_A_DISC = 4  # at most

STEP = np.dtype(
    [
        ("number", "i8"),  # of the step, from time 0
        ("cursor", "i8"),  # what has been dealt with in it: discs, then pairs
        ("pairs", "i8"),  # listed
        ("furthest", "f8"),  # square of the longest way in this step
        ("spent", "f8"),  # how much nearer two discs may be than when they were listed
    ]
)


class Nearby(NamedTuple):
    """pairs: (M, 2) i4, listed. cell, order: (N,) i4, first: (columns * rows + 1,) i4: discs in order of their cells.

    skin: length by which listed discs may be apart.
    """

    pairs: np.ndarray
    cell: np.ndarray
    order: np.ndarray
    first: np.ndarray
    columns: int
    rows: int
    skin: float


def make_nearby(gas: Gas, periodic: tuple[bool, bool]) -> Nearby:
    """Nothing listed yet."""
    n, widest = len(gas), 2.0 * float(gas.radius.max())
    skin = max(math.sqrt(NEAR * gas.area / (math.pi * n)) - widest, LEAST_SKIN * widest)
    size = max(widest + skin, math.sqrt(gas.area / (CELLS_A_DISC * n)))
    columns, rows = (max(int(length / size), 1) for length in gas.box)
    if periodic[0] and columns < 3:  # two would be neighbours on both sides
        columns = 1
    if periodic[1] and rows < 3:
        rows = 1
    cell, order = np.empty((2, n), np.int32)
    pairs, first = np.empty((4 * n, 2), np.int32), np.empty(columns * rows + 1, np.int32)
    return Nearby(pairs, cell, order, first, columns, rows, skin)


@inline
def sort_into_cells(record, ids, box, near, periodic):
    """Counting sort of the discs by cell; those outside belong to the cell next to them."""
    near.first[:] = 0
    for i in range(record.shape[0]):
        disc = record[U(i)]
        wrap(disc, ids[U(i)], periodic)
        column = min(max(np.int64(disc.x / box[0] * near.columns), 0), near.columns - 1)
        row = min(max(np.int64(disc.y / box[1] * near.rows), 0), near.rows - 1)
        near.cell[U(i)] = row * near.columns + column
        near.first[U(near.cell[U(i)])] += 1
    for c in range(1, near.first.shape[0]):
        near.first[U(c)] += near.first[U(c - 1)]
    for i in range(record.shape[0] - 1, -1, -1):
        c = near.cell[U(i)]
        near.first[U(c)] -= 1
        near.order[U(near.first[U(c)])] = i


@inline
def neighbour_cell(near, column, row, k, periodic):
    """One of a cell's four neighbours to the right and above; -1 if there is none."""
    column += 1 if k == 0 else k - 2
    row += 0 if k == 0 else 1
    if is_periodic(periodic, False) and near.columns > 1:
        column = (column + near.columns) % near.columns
    if is_periodic(periodic, True) and near.rows > 1:
        row %= near.rows
    inside = (column >= 0) & (column < near.columns) & (row < near.rows)
    return row * near.columns + column if inside else -1


@njit
def list_pairs(record, ids, box, near, periodic):
    """List the pairs within reach; the number of them, of which only those that there is room for are listed."""
    sort_into_cells(record, ids, box, near, periodic)
    count = 0
    for c in range(near.columns * near.rows):
        for k in range(-1, 4):
            other = c if k < 0 else neighbour_cell(near, c % near.columns, c // near.columns, k, periodic)
            if other < 0:
                continue
            for p in range(near.first[U(c)], near.first[U(c + 1)]):
                i = near.order[U(p)]
                for q in range(p + 1 if k < 0 else near.first[U(other)], near.first[U(other + 1)]):
                    j = near.order[U(q)]
                    x, y = separation(record[U(i)], record[U(j)], periodic)
                    reach = record[U(i)].r + record[U(j)].r + near.skin
                    if x * x + y * y < reach * reach:
                        if count < near.pairs.shape[0]:
                            near.pairs[U(count), 0] = i
                            near.pairs[U(count), 1] = j
                        count += 1
    return count


@inline
def side_beyond(disc, box, periodic):
    """The side of the box that a disc reaches through on its way out; -1 if there is none."""
    if not is_periodic(periodic, False):
        if disc.x < disc.r and disc.vx < 0.0:
            return 0
        if disc.x > box[0] - disc.r and disc.vx > 0.0:
            return 1
    if not is_periodic(periodic, True):
        if disc.y < disc.r and disc.vy < 0.0:
            return 2
        if disc.y > box[1] - disc.r and disc.vy > 0.0:
            return 3
    return -1


@inline
def fly(record, step, box, time, effects):
    """Move discs to a time, from the cursor to the first that reaches through a side: which side; -1 if none does."""
    furthest = step.furthest
    side = -1
    cursor = step.cursor
    while cursor < record.shape[0]:
        disc = record[U(cursor)]
        x = disc.x
        y = disc.y
        advance(disc, time, effects.gravity)
        furthest = max(furthest, (disc.x - x) ** 2 + (disc.y - y) ** 2)
        side = side_beyond(disc, box, effects.periodic)
        if side >= 0:
            break
        cursor += 1
    step.furthest = furthest
    step.cursor = cursor
    return side


@inline
def find_overlap(record, step, near, periodic):
    """Move the cursor to the first pair that overlaps and comes nearer: how deep, of the radii; -1 if there is none."""
    cursor = step.cursor - record.shape[0]
    depth = -1.0
    while cursor < step.pairs:
        a = record[U(near.pairs[U(cursor), 0])]
        b = record[U(near.pairs[U(cursor), 1])]
        x, y = separation(a, b, periodic)
        square = x * x + y * y
        reach = a.r + b.r
        if square < reach * reach and x * (a.vx - b.vx) + y * (a.vy - b.vy) < 0.0:
            depth = 1.0 - math.sqrt(square) / reach
            break
        cursor += 1
    step.cursor = cursor + record.shape[0]
    return depth


@njit
def advance_steps(
    record,
    ids,
    box,
    near,
    step,
    dt,
    deepest,
    effects,
    limits,
    epoch_start,
    batch,
    counters,
):
    """Take steps up to the limits, or until the batch or the list of pairs is full.

    Return the number of rows written, and whether everything up to the limit of time has happened. A limit may be
    reached in the middle of a step; it goes on from there. deepest: (1,) f8, overlap at a collision, of the sum of the
    radii.
    """
    s = step[0]
    number = record.shape[0]
    capacity = batch_capacity(batch)
    rows = events = collisions = 0
    now = counters[0].time
    reached = False
    while events < limits.events and collisions < limits.collisions and rows < capacity:
        time = s.number * dt - epoch_start
        if time > limits.until:
            reached = True
            break
        if s.cursor < number:
            side = fly(record, s, box, time, effects)
            if side >= 0:
                disc = record[U(s.cursor)]
                resolve_side(disc, ids[U(s.cursor)], side, time, effects)
                rows += write_side_hit(batch, rows, epoch_start + time, ids[U(s.cursor)], side, disc, effects)
                events += 1
                now = time
                continue
            s.spent += 2.0 * math.sqrt(s.furthest)
            s.furthest = 0.0
        if s.spent > near.skin:
            s.pairs = list_pairs(record, ids, box, near, effects.periodic)
            if s.pairs > near.pairs.shape[0]:
                break
            s.spent = 0.0
        depth = find_overlap(record, s, near, effects.periodic)
        if depth < 0.0:
            s.number += 1
            s.cursor = 0
            continue
        i = near.pairs[U(s.cursor - number), 0]
        j = near.pairs[U(s.cursor - number), 1]
        a = record[U(i)]
        b = record[U(j)]
        images = nearest_images(a.x - b.x, a.y - b.y, effects.periodic)
        resolve_pair(a, b, ids[U(i)], ids[U(j)], time, images, effects)
        rows += write_pair(batch, rows, epoch_start + time, record, ids, i, j, effects)
        deepest[0] = max(deepest[0], depth)
        events += 1
        collisions += 1
        now = time
    add_to_counters(counters[0], events, collisions, 0, 0, now, 0)
    return rows, reached


class TimeDriven:
    """The method as an object: what an epoch needs between its start and its end; steps end at multiples of dt."""

    without_positions = False
    single_epoch = False

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._deepest = np.zeros(1)

    def start(self, gas: Gas, effects: Effects) -> None:
        """Begin an epoch, which may cut a step in two: discs fly on as they did."""
        self._near = make_nearby(gas, periodic_axes(effects.periodic))
        self.discs = make_discs(gas, np.arange(len(gas)))
        list_pairs(*self.discs, self._near, effects.periodic)
        self.discs = make_discs(gas, self._near.order.copy())
        self._effects = effects
        self._step = np.zeros(1, STEP).view(np.recarray)
        self._step[0].spent = math.inf

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """See `advance_steps`."""
        record, ids, box = self.discs
        step = self._step[0]
        if step.number == 0:
            step.number = math.floor(epoch_start / self._dt) + 1
        if step.pairs > len(self._near.pairs):
            self._near = self._near._replace(pairs=np.empty((2 * step.pairs, 2), np.int32))
        return advance_steps(
            record, ids, box, self._near, self._step, self._dt, self._deepest, self._effects, limits,
            epoch_start, batch, counters,
        )  # fmt: skip

    def deepest_overlap(self) -> float:
        """The deepest with which discs have collided so far."""
        return float(self._deepest[0])
