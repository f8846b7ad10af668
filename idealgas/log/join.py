"""Join of event rows with the states of their discs before each event."""

from collections.abc import Collection, Iterator
from typing import Any

import numpy as np

from idealgas.columns import BLOCK
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
        self._make_room(BLOCK)

    def _make_room(self, rows: int) -> None:
        self._room = rows
        self._states = {
            name: np.concatenate((values[: self.discs], np.empty((rows, *values.shape[1:]), values.dtype)))
            for name, values in self._states.items()
        }

    def pass_on(self, rows: Arrays) -> Arrays:
        """States of the discs before each event row; then advance the latest states through the rows."""
        number = len(rows["disc"])
        if number > self._room:
            self._make_room(number)
        previous, discs, newest = self._places(rows["disc"])
        before = {}
        for name, values in self._states.items():
            values[self.discs : self.discs + number] = rows[name]
            before[name] = values.take(previous, axis=0)
            values[discs] = values.take(newest, axis=0)
        return before | {"disc": rows["disc"]}

    def _places(self, disc: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return where the states before and after event rows are.

        Args:
            disc: (n,), disc of each row.

        Returns:
            (n,), index of the state of the disc before each row; the discs that have rows; index of the last state of
            each of them.
        """
        order = np.lexsort((disc.astype(np.uint16), (disc >> 16).astype(np.uint16)))  # in linear time, by radix
        ordered = disc[order]
        is_first = np.ones(len(disc), np.bool_)  # row of its disc
        is_first[1:] = ordered[1:] != ordered[:-1]
        first, state = np.flatnonzero(is_first), self.discs + order
        before = np.roll(state, 1)
        before[first] = ordered[first]
        previous = np.empty_like(before)
        previous[order] = before
        return previous, ordered[first], state[np.append(first, len(disc))[1:] - 1]

    def states(self, discs: np.ndarray) -> Arrays:
        """Latest states of some discs."""
        found = {name: values.take(discs, axis=0) for name, values in self._states.items()}
        return found | {"disc": discs.astype(np.uint32)}
