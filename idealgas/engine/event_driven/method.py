"""The event-driven method: cells find the neighbours, a tournament tree finds the next event.

Every prediction is a pure function of the records involved, so the trajectory does not depend on cells, schedule or
batches. The disc that predicted last owns a pair's contact; a contact whose partner has had an event since is stale and
predicted again.
"""

import numpy as np

from idealgas._jit import inline, njit
from idealgas.engine.event_driven.cells import Cells, cell_index, cell_of, discs_per_cell, enter, make_cells
from idealgas.engine.event_driven.contacts import extend_contact, predict_contact
from idealgas.engine.event_driven.crossings import cross_cell, predict_crossing
from idealgas.engine.event_driven.overlap import deepest_overlap
from idealgas.engine.event_driven.piston import is_piston, offer_to_piston, predict_piston
from idealgas.engine.event_driven.scheduler import (
    SIDE_OF_BOX,
    clear,
    contact_is_next,
    images_of,
    next_disc,
    schedule,
    segment_of,
)
from idealgas.engine.event_driven.state import make_state
from idealgas.engine.event_driven.wall_cells import WallCells, make_wall_cells
from idealgas.engine.records import NOTHING_KEPT, Limits, add_to_counters, check_clock, make_discs
from idealgas.engine.resolve import resolve_pair, resolve_piston, resolve_segment, resolve_side, resolve_stop
from idealgas.engine.rows import batch_capacity, write_pair, write_piston_hit, write_segment_hit, write_side_hit
from idealgas.events import EventBatch
from idealgas.gas.state import Gas
from idealgas.physics.effects import Effects

U = np.uintp


@inline
def predict(record, ids, state, i, now, effects):
    """Predict disc i's next contact and its next crossing, and enter the earlier one in the schedule."""
    predict_contact(record, ids, state, i, now, effects)
    predict_crossing(record, ids, state, i, now, effects)
    schedule(state.tree, state.prediction, ids, i)
    offer_to_piston(record, ids, state, i, effects.piston, effects.gravity)


@inline
def predict_contact_again(record, ids, state, i, now, effects):
    """Predict another contact of disc i, whose partner has had an event since, and enter it in the schedule."""
    predict_contact(record, ids, state, i, now, effects)
    schedule(state.tree, state.prediction, ids, i)


@inline
def enter_next_cell(record, ids, state, i, crossing_code, now, effects):
    """Move disc i to the next cell; its record is not changed, and the contact predicted before stays valid."""
    cross_cell(record, ids, state, i, crossing_code, effects.periodic)
    extend_contact(record, ids, state, i, crossing_code, now, effects)
    predict_crossing(record, ids, state, i, now, effects)
    schedule(state.tree, state.prediction, ids, i)


@njit
def rebuild(record, ids, state, effects):
    """Fill cells, predictions and schedule from records whose column and row are set."""
    state.cells.head[:] = -1
    for i in range(record.shape[0]):
        enter(state.cells, i, cell_index(state.cells, record[U(i)]))
    clear(state.tree.key)
    predict_piston(record, ids, state, effects.piston, effects.gravity)
    for i in range(record.shape[0]):
        predict(record, ids, state, i, 0.0, effects)


@njit
def advance_events(record, ids, state, effects, limits, epoch_start, batch, counters):
    """Process events up to the limits, or until the batch is full.

    Returns the number of rows written, and whether everything up to the limit of time has happened. batch: None where
    no log is kept. counters: (1,) COUNTERS, updated.
    """
    events = 0
    collisions = 0
    crossings = 0
    stale = 0
    rows = 0
    now = counters[0].time
    events_at_this_time = counters[0].events_at_this_time
    reached = False
    capacity = batch_capacity(batch)
    while events < limits.events and collisions < limits.collisions and rows < capacity:
        i = next_disc(state.tree)
        prediction = state.prediction[U(i)]
        at_contact = contact_is_next(prediction, ids, i)
        time = prediction.contact if at_contact else prediction.crossing
        if time > limits.until:
            reached = True
            break
        other = np.int64(-1)
        if is_piston(i, ids, effects.piston):
            i = np.int64(prediction.partner)
            if not at_contact:
                resolve_stop(time, effects.piston)
            if not at_contact or record[U(i)].count != prediction.partner_count:
                stale += at_contact
                predict_piston(record, ids, state, effects.piston, effects.gravity)
                continue
            resolve_piston(record[U(i)], ids[U(i)], time, effects.piston, effects)
            predict_piston(record, ids, state, effects.piston, effects.gravity)
            rows += write_piston_hit(batch, rows, epoch_start + time, ids[U(i)], effects.piston, record[U(i)], effects)
        elif at_contact and prediction.partner >= 0:
            other = np.int64(prediction.partner)
            if record[U(other)].count != prediction.partner_count:
                stale += 1
                predict_contact_again(record, ids, state, i, time, effects)
                continue
            images = images_of(prediction)
            resolve_pair(record[U(i)], record[U(other)], ids[U(i)], ids[U(other)], time, images, effects)
            rows += write_pair(batch, rows, epoch_start + time, record, ids, i, other, effects)
            collisions += 1
        elif at_contact:
            wall = segment_of(prediction.partner)
            at_end = resolve_segment(
                record[U(i)], ids[U(i)], wall, time, images_of(prediction), effects.segments, effects
            )
            rows += write_segment_hit(batch, rows, epoch_start + time, ids[U(i)], wall, at_end, record[U(i)], effects)
        elif prediction.crossing_code < SIDE_OF_BOX:
            crossings += 1
            enter_next_cell(record, ids, state, i, prediction.crossing_code, time, effects)
            continue
        else:
            side = prediction.crossing_code - SIDE_OF_BOX
            resolve_side(record[U(i)], ids[U(i)], side, time, effects)
            rows += write_side_hit(batch, rows, epoch_start + time, ids[U(i)], side, record[U(i)], effects)
        while i >= 0:  # one call for both discs: a second call would double the machine code
            predict(record, ids, state, i, time, effects)
            i, other = other, np.int64(-1)
        events += 1
        events_at_this_time = check_clock(time, now, events_at_this_time, record.shape[0])
        now = time
    add_to_counters(counters[0], events, collisions, crossings, stale, now, events_at_this_time)
    return rows, reached


class EventDriven:
    """The event-driven method: its records, effects and predictions between the start and the end of an epoch."""

    without_positions = False
    single_epoch = False
    kept = NOTHING_KEPT

    def __init__(self, filling: float | None = None) -> None:
        """Set the mean number of discs per cell, by default chosen by packing fraction; it changes the speed only."""
        self._filling = filling
        self._walls: tuple[bytes, WallCells] | None = None

    def start(self, gas: Gas, effects: Effects) -> None:
        """Begin an epoch: sort the discs in memory by cell, and predict the next events of all."""
        filling = self._filling or discs_per_cell(gas.packing_fraction)
        largest_radius = float(gas.radius.max())
        cells = make_cells(len(gas), gas.box, largest_radius, filling)
        column, row = cell_of(gas.position, cells)
        order = np.argsort(row * cells.columns + column, kind="stable")
        self.discs = make_discs(gas, order)
        self.discs.record.column, self.discs.record.row = column[order], row[order]
        self._effects = effects
        self._state = make_state(len(gas), cells, effects, self._wall_cells(effects, cells, largest_radius))
        rebuild(self.discs.record, self.discs.id, self._state, effects)

    def _wall_cells(self, effects: Effects, cells: Cells, largest_radius: float) -> WallCells | None:
        """Wall segments of each cell: those of the epoch before, unless a gate has opened or closed since."""
        if effects.segments is None:
            return None
        active = effects.segments.active.tobytes()
        if self._walls is None or self._walls[0] != active:
            self._walls = active, make_wall_cells(effects.segments, effects.periodic, cells, largest_radius)
        return self._walls[1]

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Process events, see `advance_events`."""
        record, ids, _ = self.discs
        return advance_events(record, ids, self._state, self._effects, limits, epoch_start, batch, counters)

    def deepest_overlap(self) -> float:
        """Deepest overlap at the start of the epoch, divided by the sum of the radii; to be called before `advance`."""
        return deepest_overlap(self.discs.record, self._state, self._effects.periodic)
