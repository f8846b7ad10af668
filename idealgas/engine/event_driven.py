"""The event-driven method: cells find the neighbours, a tournament tree finds the next event.

Every prediction is a pure function of the records involved, so the trajectory does not depend on cells, schedule or
batches. The disc that predicted last owns a pair; a contact whose partner has moved on since is stale and re-predicted.
"""

from typing import NamedTuple

import numpy as np

from idealgas._jit import borrowed, inline, njit
from idealgas.engine.audit import deepest_overlap
from idealgas.engine.cells import Cells, cell_index, cell_of, discs_per_cell, enter, leave, make_cells
from idealgas.engine.order import precedes
from idealgas.engine.records import Limits, aligned, make_discs
from idealgas.engine.rows import DISC, WALL, write_row
from idealgas.engine.schedule import (
    NO_CONTACT,
    PREDICTION,
    SIDE_OF_BOX,
    Tree,
    clear,
    contact_is_next,
    make_tree,
    next_disc,
    schedule,
)
from idealgas.events import EventBatch
from idealgas.gas import Gas
from idealgas.physics.box_side import arrival_delay, centre_range, reflect
from idealgas.physics.disc_disc import collide, contact_time, first_touch
from idealgas.physics.motion import advance

U = np.uintp


class Agenda(NamedTuple):
    """What the method knows beyond the discs, all of it rebuilt at the start of an epoch.

    cells, tree: see there. prediction: (N,) PREDICTION. candidates: scratch for places of discs.
    """

    cells: Cells
    tree: Tree
    prediction: np.ndarray
    candidates: np.ndarray


def make_agenda(n: int, cells: Cells) -> Agenda:
    """An agenda with nothing predicted; `rebuild` fills it."""
    return Agenda(cells, make_tree(n), aligned(n, PREDICTION), np.empty(n + 16, np.int32))


@inline
def test_candidates(record, ids, agenda, count, i, now):
    """Keep disc i's earliest contact among the candidates; the chains behind them are appended on the way.

    The quick loop has no branches; ties and contacts at this very instant are rare and settled by `test_carefully`.
    """
    candidates = agenda.candidates
    prediction = agenda.prediction[U(i)]
    disc = record[U(i)]
    best = prediction.contact
    partner = -1
    tied = False
    k = 0
    while k < count:
        j = candidates[U(k)]
        behind = agenda.cells.link[U(j)].next
        candidates[U(count)] = behind
        count += 1 if behind >= 0 else 0
        time = first_touch(disc, record[U(j)])
        tied |= time == best
        hit = time < best
        best = time if hit else best
        partner = j if hit else partner
        k += 1
    if tied | (best <= now):
        test_carefully(record, ids, agenda, count, i)
    elif partner >= 0:
        prediction.contact = best
        prediction.partner = partner
        prediction.partner_count = record[U(partner)].count


@njit
def test_carefully(record, ids, agenda, count, i):
    """What `test_candidates` is for, with the rules for ties and for collisions that are done."""
    prediction = agenda.prediction[i]
    own = np.int64(ids[i])
    for j in agenda.candidates[:count]:
        time = contact_time(record[i], record[j])
        earlier = time < prediction.contact
        if time == prediction.contact:
            earlier = precedes(own, np.int64(ids[j]), own, np.int64(ids[prediction.partner]))
        if earlier:
            prediction.contact = time
            prediction.partner = j
            prediction.partner_count = record[j].count


@inline
def predict_contact(record, ids, agenda, i, now):
    """Disc i's earliest contact with any disc of its own and the eight cells around."""
    cells = agenda.cells
    prediction = agenda.prediction[U(i)]
    prediction.contact = NO_CONTACT
    prediction.partner = -1
    corner = cell_index(cells, record[U(i)]) - cells.columns - 1
    count = 0
    for _ in range(3):
        for across in range(3):
            j = cells.head[U(corner + across)]
            agenda.candidates[U(count)] = j
            count += 1 if j >= 0 else 0
        corner += cells.columns
    test_candidates(record, ids, agenda, count, i, now)


@inline
def extend_contact(record, ids, agenda, i, exit_code, now):
    """After a step into the next cell: test the three cells that came within reach."""
    cells = agenda.cells
    forward = 1 if exit_code & 1 else -1
    cell = cell_index(cells, record[U(i)])
    along_y = exit_code >= 2
    first = cell + (forward * cells.columns - 1 if along_y else forward - cells.columns)
    stride = 1 if along_y else cells.columns
    count = 0
    for _ in range(3):
        j = cells.head[U(first)]
        agenda.candidates[U(count)] = j
        count += 1 if j >= 0 else 0
        first += stride
    test_candidates(record, ids, agenda, count, i, now)


@inline
def predict_exit(record, agenda, i):
    """When and where disc i leaves its cell or meets a side of the box."""
    cells = agenda.cells
    disc = record[U(i)]
    right = disc.vx > 0.0
    up = disc.vy > 0.0
    column = np.int64(disc.column) if right else np.int64(disc.column) - 1
    row = np.int64(disc.row) if up else np.int64(disc.row) - 1
    low, high = centre_range(cells.Lx, disc.r)
    x_time = disc.t + arrival_delay(disc.x, disc.vx, min(max(column * cells.width, low), high))
    low, high = centre_range(cells.Ly, disc.r)
    y_time = disc.t + arrival_delay(disc.y, disc.vy, min(max(row * cells.height, low), high))
    along_y = y_time < x_time
    edge = row if along_y else column
    last = cells.rows - 2 if along_y else cells.columns - 2
    forward = up if along_y else right
    prediction = agenda.prediction[U(i)]
    prediction.exit = y_time if along_y else x_time
    side = (2 if along_y else 0) + (1 if forward else 0)
    prediction.exit_code = side + (SIDE_OF_BOX if (edge == 0) | (edge == last) else 0)


@inline
def predict(record, ids, agenda, i, now):
    """Everything disc i meets next, entered in the schedule."""
    predict_contact(record, ids, agenda, i, now)
    predict_exit(record, agenda, i)
    schedule(agenda.tree, agenda.prediction, ids, i)


@inline
def step_into_next_cell(record, ids, agenda, i, exit_code, now):
    """Membership changes, the record does not; the contact found so far stays valid."""
    disc = record[U(i)]
    leave(agenda.cells, i, cell_index(agenda.cells, disc))
    forward = 1 if exit_code & 1 else -1
    if exit_code >= 2:
        disc.row += forward
    else:
        disc.column += forward
    enter(agenda.cells, i, cell_index(agenda.cells, disc))
    extend_contact(record, ids, agenda, i, exit_code, now)
    predict_exit(record, agenda, i)
    schedule(agenda.tree, agenda.prediction, ids, i)


@njit
def rebuild(record, ids, agenda):
    """Fill cells, predictions and schedule from records whose column and row are set."""
    record, ids, agenda = borrowed((record, ids, agenda))
    agenda.cells.head[:] = -1
    for i in range(record.shape[0]):
        enter(agenda.cells, i, cell_index(agenda.cells, record[i]))
    clear(agenda.tree.key)
    for i in range(record.shape[0]):
        predict(record, ids, agenda, i, 0.0)


@njit
def advance_events(record, ids, agenda, until, most_events, most_collisions, epoch_start, batch, counters):
    """Process events up to local time `until`, or to a limit, or until the batch is full.

    Return the number of rows written and whether everything up to `until` has happened.


    batch: None where no log is kept. counters: (1,) COUNTERS, updated.
    """
    record, ids, agenda = borrowed((record, ids, agenda))
    events = 0
    collisions = 0
    crossings = 0
    stale = 0
    rows = 0
    now = counters[0].time
    reached = False
    capacity = 0
    if batch is not None:
        capacity = batch.time.shape[0] - 1
    while events < most_events and collisions < most_collisions:
        if batch is not None and rows >= capacity:
            break
        i = next_disc(agenda.tree)
        prediction = agenda.prediction[U(i)]
        if contact_is_next(prediction, ids, i):
            time = prediction.contact
            if time > until:
                reached = True
                break
            j = prediction.partner
            if record[U(j)].count != prediction.partner_count:
                stale += 1
                predict_contact(record, ids, agenda, i, time)
                schedule(agenda.tree, agenda.prediction, ids, i)
                continue
            advance(record[U(i)], time)
            advance(record[U(j)], time)
            collide(record[U(i)], record[U(j)])
            record[U(i)].count += 1
            record[U(j)].count += 1
            if batch is not None:
                first, second = (i, j) if ids[U(i)] < ids[U(j)] else (j, i)
                a = ids[U(first)]
                b = ids[U(second)]
                write_row(batch, rows, epoch_start + time, a, b, DISC, record[U(first)])
                write_row(batch, rows + 1, epoch_start + time, b, a, DISC, record[U(second)])
                rows += 2
            predict(record, ids, agenda, i, time)
            predict(record, ids, agenda, j, time)
            collisions += 1
        else:
            time = prediction.exit
            if time > until:
                reached = True
                break
            code = prediction.exit_code
            if code < SIDE_OF_BOX:
                crossings += 1
                step_into_next_cell(record, ids, agenda, i, code, time)
                continue
            side = code - SIDE_OF_BOX
            advance(record[U(i)], time)
            reflect(record[U(i)], side)
            record[U(i)].count += 1
            if batch is not None:
                write_row(batch, rows, epoch_start + time, ids[U(i)], -1 - side, WALL, record[U(i)])
                rows += 1
            predict(record, ids, agenda, i, time)
        events += 1
        if time < now:
            raise ValueError("time ran backwards")
        now = time
    counter = counters[0]
    counter.events += events
    counter.disc_collisions += collisions
    counter.wall_hits += events - collisions
    counter.crossings += crossings
    counter.stale += stale
    counter.time = now
    return rows, reached


class EventDriven:
    """The method as an object: what an epoch needs between its start and its end."""

    def __init__(self, filling: float | None = None) -> None:
        """filling: discs per cell, chosen by packing fraction if not given; it changes the speed and nothing else."""
        self._filling = filling

    def start(self, gas: Gas) -> None:
        """Begin an epoch: put the discs in memory in the order of their cells and predict everything."""
        filling = self._filling or discs_per_cell(gas.packing_fraction)
        cells = make_cells(len(gas), gas.box, float(gas.radius.max()), filling)
        column, row = cell_of(gas.position, cells)
        order = np.argsort(row * cells.columns + column, kind="stable")
        self.discs = make_discs(gas, order)
        self.discs.record.column, self.discs.record.row = column[order], row[order]
        self._agenda = make_agenda(len(gas), cells)
        rebuild(self.discs.record, self.discs.id, self._agenda)

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """See `advance_events`."""
        record, ids, _ = self.discs
        return advance_events(record, ids, self._agenda, *limits, epoch_start, batch, counters)

    def deepest_overlap(self) -> float:
        """Deepest overlap at the start of the epoch; call it before `advance`."""
        return deepest_overlap(self.discs.record, self._agenda.cells)
