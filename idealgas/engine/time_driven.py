"""The time-driven method: all discs move for a time step; then discs that overlap or protrude from the box collide.

The method serves for comparison with the event-driven method; its errors grow with the step. A contact is detected
late, by half a step on average, and with a rotated line of centres. It is missed if no step ends while the discs
overlap and still approach each other. The implementation is as fast as possible: near pairs are listed with the help of
cells, and the list is used until two discs may have approached each other by `skin` (Verlet, Phys. Rev. 159, 98 (1967);
Allen & Tildesley, Computer Simulation of Liquids, 2nd ed. (2017), ch. 5.3).
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.columns import EventBatch
from idealgas.effects.bundle import Effects
from idealgas.engine.event_writer import WALL, batch_capacity, write_hit, write_pair
from idealgas.engine.method import Limits, Method
from idealgas.engine.records import add_to_counters, make_discs
from idealgas.engine.resolve import resolve_pair, resolve_side
from idealgas.jit import inline, njit
from idealgas.physics.motion import advance
from idealgas.physics.periodic import is_periodic, nearest_images, periodic_axes, separation, wrap
from idealgas.state import Gas

U = np.uintp
NEAR = 3.0  # mean number of discs in the neighbourhood that is listed for a disc; the fastest choice in benchmarks
LEAST_SKIN = 0.2  # smallest skin, in diameters
CELLS_PER_DISC = 4  # largest number of cells per disc

STEP = np.dtype(
    [
        ("dt", "f8"),  # length of a step, time
        ("number", "i8"),  # number of the step, counted from time 0
        ("cursor", "i8"),  # number of discs, and after these of pairs, that are finished in this step
        ("pairs", "i8"),  # number of listed pairs
        ("furthest", "f8"),  # square of the largest displacement of a disc in this step, length²
        ("spent", "f8"),  # distance by which two discs may have approached since the pairs were listed, length
        ("deepest", "f8"),  # deepest overlap in a collision of this epoch, divided by the sum of the radii
    ]
)


class Nearby(NamedTuple):
    """List of near pairs, and the cells from which it is built.

    Attributes:
        pairs: (M, 2) i4, indices of the two discs of each near pair.
        cell: (N,) i4, cell of each disc.
        order: (N,) i4, indices of the discs in order of their cells.
        first: (columns * rows + 1,) i4, position in `order` of each cell's first disc.
        columns: number of cells along x.
        rows: number of cells along y.
        skin: largest gap between the surfaces of two listed discs, length.
    """

    pairs: np.ndarray
    cell: np.ndarray
    order: np.ndarray
    first: np.ndarray
    columns: int
    rows: int
    skin: float


def make_nearby(gas: Gas, periodic: tuple[bool, bool]) -> Nearby:
    """Make cells and an empty list of pairs for a gas; periodic: whether the sides along x and y are periodic."""
    n, widest = len(gas), 2.0 * float(gas.radius.max())
    skin = max(math.sqrt(NEAR * gas.area / (math.pi * n)) - widest, LEAST_SKIN * widest)
    size = max(widest + skin, math.sqrt(gas.area / (CELLS_PER_DISC * n)))
    columns, rows = (max(int(length / size), 1) for length in gas.box)
    if periodic[0] and columns < 3:  # two cells would be neighbours on both sides
        columns = 1
    if periodic[1] and rows < 3:
        rows = 1
    cell, order = np.empty((2, n), np.int32)
    pairs, first = np.empty((4 * n, 2), np.int32), np.empty(columns * rows + 1, np.int32)
    return Nearby(pairs, cell, order, first, columns, rows, skin)


@inline
def sort_into_cells(record, ids, box, near, periodic):
    """Sort the discs by cell with a counting sort; discs outside the box belong to the nearest cell."""
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
    """Index of neighbour k (0 to 3) of a cell, one of the four to the right and above; -1 if it does not exist."""
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
    """List pairs of discs with a gap below the skin until the list is full; return the number of all such pairs."""
    sort_into_cells(record, ids, box, near, periodic)
    count = 0
    for c in range(near.columns * near.rows):
        for k in range(-1, 4):
            neighbour = c if k < 0 else neighbour_cell(near, c % near.columns, c // near.columns, k, periodic)
            if neighbour < 0:
                continue
            for p in range(near.first[U(c)], near.first[U(c + 1)]):
                i = near.order[U(p)]
                for q in range(p + 1 if k < 0 else near.first[U(neighbour)], near.first[U(neighbour + 1)]):
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
    """Side of the box beyond which a disc protrudes while it moves outwards; -1 if there is none."""
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
    """Move the discs, starting at the cursor, to a local time, and stop at the first that protrudes beyond a side.

    Returns that side, or -1 if no disc protrudes.
    """
    furthest = step.furthest
    side = -1
    cursor = step.cursor
    while cursor < record.shape[0]:
        disc = record[U(cursor)]
        before_x, before_y = disc.x, disc.y
        advance(disc, time, effects.gravity)
        x, y = disc.x - before_x, disc.y - before_y
        furthest = max(furthest, x * x + y * y)
        side = side_beyond(disc, box, effects.periodic)
        if side >= 0:
            break
        cursor += 1
    step.furthest = furthest
    step.cursor = cursor
    return side


@inline
def find_overlap(record, step, near, periodic):
    """Move the cursor to the first listed pair of discs that overlap and approach.

    Returns the overlap divided by the sum of the radii, or -1 if there is no such pair.
    """
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
def advance_steps(discs, near, step, effects, limits, epoch_start, batch, counters):
    """Take steps up to the limits, or until the batch or the list of pairs is full.

    Returns the number of rows written, and whether all events up to the time limit have happened. A limit may be
    reached in the middle of a step; the next call continues from there. step: (1,) STEP, updated.
    """
    record, ids, box = discs
    s = step[0]
    number = record.shape[0]
    capacity = batch_capacity(batch)
    rows = events = collisions = 0
    now = counters[0].time
    reached = False
    while events < limits.events and collisions < limits.collisions and rows < capacity:
        time = s.number * s.dt - epoch_start
        if time > limits.until:
            reached = True
            break
        if s.cursor < number:
            side = fly(record, s, box, time, effects)
            if side >= 0:
                disc = record[U(s.cursor)]
                resolve_side(disc, ids[U(s.cursor)], side, time, effects)
                rows += write_hit(batch, rows, epoch_start + time, ids[U(s.cursor)], -1 - side, WALL, disc, effects)
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
        s.deepest = max(s.deepest, depth)
        events += 1
        collisions += 1
        now = time
    add_to_counters(counters[0], events, collisions, 0, now, 0)
    return rows, reached


def first_step_after(time: float, dt: float) -> int:
    """Return the number of the first step that ends after a time; step k ends at the float nearest to k dt."""
    number = math.floor(time / dt)  # because the quotient is rounded, this may be off by 1 in either direction
    while number * dt > time:
        number -= 1
    while number * dt <= time:
        number += 1
    return number


class TimeDriven(Method):
    """The time-driven method, with the discs and effects of the current epoch; steps end at multiples of dt."""

    def __init__(self, dt: float) -> None:
        """Set the length of a step, dt (time)."""
        self._step = np.zeros(1, STEP).view(np.recarray)
        self._step[0].dt = dt
        self._overlap = 0.0

    def start(self, gas: Gas, effects: Effects) -> None:
        """Begin an epoch. It may begin within a step, because the discs then simply continue to move."""
        super().start(gas, effects)
        self._near = make_nearby(gas, periodic_axes(effects.periodic))
        list_pairs(*self.discs, self._near, effects.periodic)
        self.discs = make_discs(gas, self._near.order.copy())
        step = self._step[0]
        self._overlap = float(step.deepest)
        step.number = step.cursor = step.pairs = 0
        step.furthest = step.deepest = 0.0
        step.spent = math.inf

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Take steps; see `advance_steps`."""
        step = self._step[0]
        if step.number == 0:
            step.number = first_step_after(epoch_start, step.dt)
        if step.pairs > len(self._near.pairs):
            self._near = self._near._replace(pairs=np.empty((2 * step.pairs, 2), np.int32))
        return advance_steps(self.discs, self._near, self._step, self._effects, limits, epoch_start, batch, counters)

    def deepest_overlap(self, gas: Gas, effects: Effects) -> float:
        """Deepest overlap in a collision in this epoch or, at its start, in the previous one, over the sum of radii."""
        return self._overlap if self._step[0].number == 0 else float(self._step[0].deepest)
