"""The brute-force method: before every event all pairs and all sides of the box are asked for the next one, O(N²).

It is the oracle of the event-driven method: the same laws, the same rule for ties, nothing remembered.
"""

import numpy as np

from idealgas._jit import inline, njit
from idealgas.engine.audit import deepest_overlap_of_all
from idealgas.engine.records import Limits, make_discs
from idealgas.engine.rows import DISC, WALL, write_row
from idealgas.events import EventBatch
from idealgas.gas import Gas
from idealgas.physics.box_side import arrival_delay, centre_range, reflect
from idealgas.physics.constants import NEVER
from idealgas.physics.disc_disc import collide, contact_time
from idealgas.physics.motion import advance


@inline
def side_contact(disc, side, box):
    """Time at which a disc meets a side of the box; NEVER if it does not move towards it."""
    low, high = centre_range(box[side >> 1], disc.r)
    position, velocity = (disc.x, disc.vx) if side < 2 else (disc.y, disc.vy)
    if side & 1:
        delay = arrival_delay(position, velocity, high) if velocity > 0.0 else NEVER
    else:
        delay = arrival_delay(position, velocity, low) if velocity < 0.0 else NEVER
    return disc.t + delay if delay < NEVER else NEVER


@inline
def next_event(record, box):
    """Time, disc and partner (-1 - side for a side of the box) of the earliest event; records are in order of id.

    The search goes through the events in the order that decides ties: smaller id, then walls, then the other id.
    """
    best = NEVER
    disc = -1
    partner = -1
    for i in range(record.shape[0]):
        for side in range(4):
            time = side_contact(record[i], side, box)
            if time < best:
                best, disc, partner = time, i, -1 - side
        for j in range(i + 1, record.shape[0]):
            time = contact_time(record[i], record[j])
            if time < best:
                best, disc, partner = time, i, j
    return best, disc, partner


@njit
def advance_events(record, box, until, most_events, most_collisions, epoch_start, batch, counters):
    """As `event_driven.advance_events`, for records in order of id."""
    counter = counters[0]
    rows = 0
    events = 0
    collisions = 0
    now = counter.time
    reached = False
    capacity = 0
    if batch is not None:
        capacity = batch.time.shape[0] - 1
    while events < most_events and collisions < most_collisions:
        if batch is not None and rows >= capacity:
            break
        time, i, partner = next_event(record, box)
        if time > until:
            reached = True
            break
        advance(record[i], time)
        if partner >= 0:
            advance(record[partner], time)
            collide(record[i], record[partner])
            collisions += 1
            if batch is not None:
                write_row(batch, rows, epoch_start + time, i, partner, DISC, record[i])
                write_row(batch, rows + 1, epoch_start + time, partner, i, DISC, record[partner])
                rows += 2
        else:
            reflect(record[i], -1 - partner)
            if batch is not None:
                write_row(batch, rows, epoch_start + time, i, partner, WALL, record[i])
                rows += 1
        events += 1
        if time < now:
            raise ValueError("time ran backwards")
        now = time
    counter.events += events
    counter.disc_collisions += collisions
    counter.wall_hits += events - collisions
    counter.time = now
    return rows, reached


class BruteForce:
    """The method as an object: what an epoch needs between its start and its end."""

    def start(self, gas: Gas) -> None:
        """Begin an epoch."""
        self.discs = make_discs(gas, np.arange(len(gas)))

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """See `advance_events`."""
        return advance_events(self.discs.record, self.discs.box, *limits, epoch_start, batch, counters)

    def deepest_overlap(self) -> float:
        """Deepest overlap at the start of the epoch; call it before `advance`."""
        return deepest_overlap_of_all(self.discs.record)
