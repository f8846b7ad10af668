"""Rows of several strips put in the one order of their times, and handed on in batches."""

from collections.abc import Sequence

import numpy as np

from idealgas.events import EventBatch, Kind


class TiedRowsError(Exception):
    """Two strips had events at one time."""


def merged(parts: Sequence[EventBatch]) -> EventBatch:
    """Rows of all parts in order of time; each part has its rows in the order in which they happened.

    A clock that was set back leaves rows out of order. Events of one time must follow each other in one part, else
    nothing says which of them came first: TiedRowsError.
    """
    times = np.concatenate([part.time for part in parts])
    order = np.argsort(times, kind="stable")
    sorted_times = times[order]
    tied = np.flatnonzero(sorted_times[1:] == sorted_times[:-1])
    starts = np.cumsum([len(part.time) for part in parts])[:-1]
    after = order[tied + 1]
    if (after != order[tied] + 1).any() or np.isin(after, starts).any():
        raise TiedRowsError
    columns = (None if column[0] is None else np.concatenate(column)[order] for column in zip(*parts, strict=True))
    return EventBatch(*columns)  # type: ignore[arg-type]


class Pending:
    """Rows that are still to be handed on."""

    def __init__(self, rows: EventBatch, epoch_start: float) -> None:
        """Take rows whose times are local ones of an epoch that starts at a time."""
        self._rows = rows._replace(time=epoch_start + rows.time)
        self._next = 0

    def __len__(self) -> int:
        """Number of rows that are left."""
        return len(self._rows.time) - self._next

    def fill(self, batch: EventBatch) -> int:
        """Fill a batch as a kernel does: both rows of a pair or none; return the number of rows."""
        room, start = len(batch.time), self._next
        stop = min(start + room - 1, len(self._rows.time))
        if stop < len(self._rows.time) and self._is_second(stop):
            stop += 1
        self._next = stop
        for to, column in zip(batch, self._rows, strict=True):
            if to is not None and column is not None:
                to[: stop - start] = column[start:stop]
        return stop - start

    def _is_second(self, row: int) -> bool:
        """Whether a row is the second one of a pair, that of the larger id."""
        disc, partner, kind = (int(column[row]) for column in (self._rows.disc, self._rows.partner, self._rows.kind))
        return kind == Kind.DISC and partner < disc
