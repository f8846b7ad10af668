"""Merging the rows of several slabs by time, and delivering them in batches."""

from collections.abc import Sequence

import numpy as np

from idealgas.columns import EventBatch, Kind
from idealgas.jit import inline, njit

U = np.uintp


class TiedRowsError(Exception):
    """Two slabs had simultaneous events, whose order is undefined."""


def time_order(time: np.ndarray, filled: Sequence[int]) -> np.ndarray:
    """Return the indices of all rows of a slice in order of time.

    Args:
        time: local times; each slab has an equal part of this memory.
        filled: number of rows of each slab, counted from the beginning of its part. They are in the order in which
            they were processed, which is not the order of time if a clock was set back.

    Returns:
        The indices (rows,), i8.

    Raises:
        TiedRowsError: simultaneous rows are not adjacent rows of the same slab, so their order is undefined.
    """
    order, sorted_rows = np.empty(sum(filled), np.int64), np.empty(len(time), np.int64)
    place, head = np.empty(len(filled), np.int64), np.empty(len(filled))
    if not merge(time, np.array(filled), sorted_rows, place, head, order):
        raise TiedRowsError
    return order


@njit
def merge(time, filled, sorted_rows, place, head, order):
    """Merge the rows of all slabs into `order` (see `time_order`); return False if their order is undefined.

    filled: (slabs,) i8. The other arrays are overwritten. sorted_rows: i8 of the same length as `time`, the sorted rows
    of each slab. place: (slabs,) i8, position in `sorted_rows` of each slab's next row. head: (slabs,) f8, time of this
    row.
    """
    slabs = filled.shape[0]
    room = time.shape[0] // slabs
    for k in range(slabs):
        place[U(k)] = k * room
        insertion_sort(time, k * room, k * room + filled[U(k)], sorted_rows)
        head[U(k)] = time[U(sorted_rows[U(k * room)])] if filled[U(k)] > 0 else np.inf
    before = -1
    for n in range(order.shape[0]):
        k = 0
        for slab in range(1, slabs):
            k = slab if head[U(slab)] < head[U(k)] else k
        row = sorted_rows[U(place[U(k)])]
        if before >= 0 and time[U(row)] == time[U(before)] and (row != before + 1 or row % room == 0):
            return False
        order[U(n)] = row
        before = row
        place[U(k)] += 1
        head[U(k)] = time[U(sorted_rows[U(place[U(k)])])] if place[U(k)] < k * room + filled[U(k)] else np.inf
    return True


@inline
def insertion_sort(time, start, stop, sorted_rows):
    """Sort the rows `start` to `stop` - 1 by time; insertion sort is fast because nearly all rows are in order."""
    for row in range(start, stop):
        at = row
        while at > start and time[U(sorted_rows[U(at - 1)])] > time[U(row)]:
            sorted_rows[U(at)] = sorted_rows[U(at - 1)]
            at -= 1
        sorted_rows[U(at)] = row


@inline
def gather_scalars(to, rows, order):
    """Copy a scalar column of the rows in the given order, if the batch has this column."""
    if to is not None:
        for k in range(order.shape[0]):
            to[U(k)] = rows[U(order[U(k)])]


@inline
def gather_vectors(to, rows, order):
    """Copy a column with two components of the rows in the given order, if the batch has this column."""
    if to is not None:
        for k in range(order.shape[0]):
            to[U(k), 0] = rows[U(order[U(k)]), 0]
            to[U(k), 1] = rows[U(order[U(k)]), 1]


@njit
def gather_rows(rows, order, epoch_start, batch):
    """Copy rows with local times into a batch in the given order; epoch_start: time at the start of the epoch."""
    for k in range(order.shape[0]):
        batch.time[U(k)] = epoch_start + rows.time[U(order[U(k)])]
    gather_scalars(batch.disc, rows.disc, order)
    gather_scalars(batch.partner, rows.partner, order)
    gather_scalars(batch.kind, rows.kind, order)
    gather_vectors(batch.position, rows.position, order)
    gather_vectors(batch.velocity, rows.velocity, order)
    gather_scalars(batch.angular_velocity, rows.angular_velocity, order)
    gather_vectors(batch.image, rows.image, order)


class PendingRows:
    """Rows that have not been delivered yet."""

    def __init__(self, rows: EventBatch, order: np.ndarray, epoch_start: float) -> None:
        """Begin with all rows, which have local times, and their order; epoch_start: time at the start of the epoch."""
        self._rows, self._order, self._epoch_start = rows, order, epoch_start
        self._next = 0

    def __len__(self) -> int:
        """Number of remaining rows."""
        return len(self._order) - self._next

    def fill(self, batch: EventBatch) -> int:
        """Fill a batch without separating the rows of a pair; return the number of rows."""
        start = self._next
        stop = min(start + len(batch.time) - 1, len(self._order))
        if stop < len(self._order) and self._is_second(self._order[stop]):
            stop += 1
        self._next = stop
        gather_rows(self._rows, self._order[start:stop], self._epoch_start, batch)
        return stop - start

    def _is_second(self, row: int) -> bool:
        """Whether a row is the second row of a pair, which belongs to the larger id."""
        disc, partner, kind = (int(column[row]) for column in (self._rows.disc, self._rows.partner, self._rows.kind))
        return kind == Kind.DISC and partner < disc
