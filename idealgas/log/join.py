"""Join each event row with the state of its disc before the event."""

from collections.abc import Collection, Iterator
from typing import Any

import numpy as np

from idealgas.columns import BLOCK
from idealgas.log.replay import LogState

Arrays = dict[str, np.ndarray]
"""Columns by name."""


def whole_pairs(chunks: Iterator[Any]) -> Iterator[Arrays]:
    """Yield chunks of event rows as columns by name, without separating the two rows of a collision."""
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
    """The latest states of all discs, updated as event rows are processed in order.

    Attributes:
        discs: number of discs.
    """

    def __init__(self, state: LogState, names: Collection[str]) -> None:
        """Start from the state of all discs at one time. names: names of the event columns in the rows."""
        self.discs = len(state.velocity)
        start = {"time": np.full(self.discs, state.time)}
        start |= {name: getattr(state, name) for name in LogState._fields[1:] if name in names}
        self._states = start  # states of the discs, followed by the states in the current rows
        self._make_room(BLOCK)

    def _make_room(self, rows: int) -> None:
        self._room = rows
        self._states = {
            name: np.concatenate((values[: self.discs], np.empty((rows, *values.shape[1:]), values.dtype)))
            for name, values in self._states.items()
        }

    def pass_on(self, rows: Arrays) -> Arrays:
        """Return the state of the disc before each event row, as columns by name, and update the latest states."""
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
        """Locate the states before event rows, and the last states of the discs in these rows.

        Args:
            disc: (n,), disc of each event row.

        Returns:
            The index (n,) of the state before each row, the ids of the discs that have rows, and the index of the last
            state of each of these discs.
        """
        order = np.lexsort((disc.astype(np.uint16), (disc >> 16).astype(np.uint16)))  # a radix sort, in linear time
        ordered = disc[order]
        is_first = np.ones(len(disc), np.bool_)  # whether a row is the first row of its disc
        is_first[1:] = ordered[1:] != ordered[:-1]
        first, state = np.flatnonzero(is_first), self.discs + order
        before = np.roll(state, 1)
        before[first] = ordered[first]
        previous = np.empty_like(before)
        previous[order] = before
        return previous, ordered[first], state[np.append(first, len(disc))[1:] - 1]

    def states(self, discs: np.ndarray) -> Arrays:
        """Return the latest states of the discs with these ids, as columns by name."""
        columns = {name: values.take(discs, axis=0) for name, values in self._states.items()}
        return columns | {"disc": discs.astype(np.uint32)}
