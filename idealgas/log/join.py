"""Join of event rows with the states of their discs before each event."""

from collections.abc import Collection, Iterator
from typing import Any

import numpy as np

from idealgas.columns import BLOCK
from idealgas.jit import njit
from idealgas.log.replay import LogState

Arrays = dict[str, np.ndarray]
"""Columns by name."""


def whole_pairs(chunks: Iterator[Any]) -> Iterator[Arrays]:
    """Yield chunks of event rows as columns by name, without splitting the two rows of a collision."""
    held: Arrays = {}
    for chunk in chunks:
        rows: Arrays = chunk._asdict()
        if held:
            rows = {name: np.concatenate((held[name], values)) for name, values in rows.items()}
            held = {}
        if "partner" in rows and rows["disc"][-1] < rows["partner"][-1]:
            held = {name: values[-1:] for name, values in rows.items()}
            rows = {name: values[:-1] for name, values in rows.items()}
        yield rows


class Join:
    """Latest states of all discs, advanced through the event rows.

    Attributes:
        discs: number of discs.
    """

    def __init__(self, state: LogState, names: Collection[str]) -> None:
        """Start with the states of all discs at one time. names: event columns that are read."""
        self.discs = len(state.velocity)
        start = {"time": np.full(self.discs, state.time)}
        start |= {name: getattr(state, name) for name in LogState._fields[1:] if name in names}
        self._states = start  # of the discs, then of the current rows
        self._latest = np.arange(self.discs)  # index of the latest state of each disc
        self._make_room(BLOCK)

    def _make_room(self, rows: int) -> None:
        self._room = rows
        self._previous, self._touched = np.empty((2, rows), np.int64)
        self._states = {
            name: np.concatenate((values[: self.discs], np.empty((rows, *values.shape[1:]), values.dtype)))
            for name, values in self._states.items()
        }

    def pass_on(self, rows: Arrays) -> Arrays:
        """States of the discs before each event row; then advance the latest states through the rows."""
        number = len(rows["disc"])
        if number > self._room:
            self._make_room(number)
        disc, previous = rows["disc"].view(), self._previous[:number]
        disc.flags.writeable = False  # as in most chunks, so that one type is compiled
        touched = self._touched[: _find_previous(disc, self._latest, previous, self._touched)]
        newest, found = self._latest[touched], {}
        for name, values in self._states.items():
            values[self.discs : self.discs + number] = rows[name]
            found[name] = values.take(previous, axis=0)
            values[touched] = values.take(newest, axis=0)
        self._latest[touched] = touched
        return found | {"disc": rows["disc"]}

    def states(self, discs: np.ndarray) -> Arrays:
        """Latest states of some discs."""
        found = {name: values.take(discs, axis=0) for name, values in self._states.items()}
        return found | {"disc": discs.astype(np.uint32)}


@njit
def _find_previous(disc: np.ndarray, latest: np.ndarray, previous: np.ndarray, touched: np.ndarray) -> int:
    """Find the index of the latest state of the disc of each row, and the ids of all discs that have rows.

    Returns the number of these discs. It is compiled because each row depends on the previous row of its disc.
    """
    discs, found = latest.shape[0], 0
    for k in range(disc.shape[0]):
        i = np.uintp(disc[k])
        previous[k] = latest[i]
        if latest[i] < discs:
            touched[found] = i
            found += 1
        latest[i] = discs + k
    return found
