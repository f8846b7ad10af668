"""Rows of several strips put in the one order of their times, and handed on in batches."""

from collections.abc import Sequence

import numpy as np

from idealgas.events import EventBatch, Kind
from idealgas.jit import inline, njit

U = np.uintp


class TiedRowsError(Exception):
    """Two strips had events at one time."""


def order_of(time: np.ndarray, filled: Sequence[int]) -> np.ndarray:
    """Indices of all rows of a slice in order of time.

    time: of the rows, in memory of all strips, as much for each. filled: how many rows each strip has, from the
    beginning of its part on, in the order in which they happened. A clock that was set back leaves rows out of order.
    Events of one time must follow each other in one strip, else nothing says which of them came first: TiedRowsError.
    """
    order, own = np.empty(sum(filled), np.int64), np.empty(len(time), np.int64)
    place, head = np.empty(len(filled), np.int64), np.empty(len(filled))
    if not merge(time, np.array(filled), own, place, head, order):
        raise TiedRowsError
    return order


@njit
def merge(time, filled, own, place, head, order):
    """Put indices of the rows of all strips in order, see `order_of`; return whether their times tell it.

    filled: (strips,) i8. own: as many i8 as times, overwritten with each strip's rows in order. place: (strips,) i8,
    and head: (strips,) f8, overwritten with each strip's next one of these, and its time.
    """
    strips = filled.shape[0]
    room = time.shape[0] // strips
    for k in range(strips):
        place[U(k)] = k * room
        put_in_order(time, k * room, k * room + filled[U(k)], own)
        head[U(k)] = time[U(own[U(k * room)])] if filled[U(k)] > 0 else np.inf
    before = -1
    for n in range(order.shape[0]):
        k = 0
        for other in range(1, strips):
            k = other if head[U(other)] < head[U(k)] else k
        row = own[U(place[U(k)])]
        if before >= 0 and time[U(row)] == time[U(before)] and (row != before + 1 or row % room == 0):
            return False
        order[U(n)] = row
        before = row
        place[U(k)] += 1
        head[U(k)] = time[U(own[U(place[U(k)])])] if place[U(k)] < k * room + filled[U(k)] else np.inf
    return True


@inline
def put_in_order(time, start, stop, own):
    """Put the rows `start` to before `stop` in order of time: by insertion, as nearly all are."""
    for row in range(start, stop):
        at = row
        while at > start and time[U(own[U(at - 1)])] > time[U(row)]:
            own[U(at)] = own[U(at - 1)]
            at -= 1
        own[U(at)] = row


@inline
def take_numbers(to, rows, order):
    """Fill a column of numbers with those of the rows in an order, where the batch has it."""
    if to is not None:
        for k in range(order.shape[0]):
            to[U(k)] = rows[U(order[U(k)])]


@inline
def take_pairs(to, rows, order):
    """Fill a column of two components with those of the rows in an order, where the batch has it."""
    if to is not None:
        for k in range(order.shape[0]):
            to[U(k), 0] = rows[U(order[U(k)]), 0]
            to[U(k), 1] = rows[U(order[U(k)]), 1]


@njit
def take_rows(rows, order, epoch_start, batch):
    """Fill a batch with rows in an order; their times are local ones of an epoch that starts at a time."""
    for k in range(order.shape[0]):
        batch.time[U(k)] = epoch_start + rows.time[U(order[U(k)])]
    take_numbers(batch.disc, rows.disc, order)
    take_numbers(batch.partner, rows.partner, order)
    take_numbers(batch.kind, rows.kind, order)
    take_pairs(batch.position, rows.position, order)
    take_pairs(batch.velocity, rows.velocity, order)
    take_numbers(batch.angular_velocity, rows.angular_velocity, order)
    take_pairs(batch.image, rows.image, order)


class Pending:
    """Rows that are still to be handed on."""

    def __init__(self, rows: EventBatch, order: np.ndarray, epoch_start: float) -> None:
        """Take rows in an order; their times are local ones of an epoch that starts at a time."""
        self._rows, self._order, self._epoch_start = rows, order, epoch_start
        self._next = 0

    def __len__(self) -> int:
        """Number of rows that are left."""
        return len(self._order) - self._next

    def fill(self, batch: EventBatch) -> int:
        """Fill a batch as a kernel does: both rows of a pair or none; return the number of rows."""
        start = self._next
        stop = min(start + len(batch.time) - 1, len(self._order))
        if stop < len(self._order) and self._is_second(self._order[stop]):
            stop += 1
        self._next = stop
        take_rows(self._rows, self._order[start:stop], self._epoch_start, batch)
        return stop - start

    def _is_second(self, row: int) -> bool:
        """Whether a row is the second one of a pair, that of the larger id."""
        disc, partner, kind = (int(column[row]) for column in (self._rows.disc, self._rows.partner, self._rows.kind))
        return kind == Kind.DISC and partner < disc
