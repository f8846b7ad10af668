"""One pass over the events of a log in bounded memory, for any number of tallies.

A tally follows every disc from event to event and adds the contributions of its flights and events to B blocks of time.
Flights are split at the edges of the blocks, so that time averages are exact. Shape of the sums: (B, …).
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from idealgas.analysis.core.equilibrium import drift
from idealgas.jit import inline
from idealgas.log import Log
from idealgas.state import Gas


class Tally(Protocol):
    """Interface of the sums that `stream` collects over the events of a log."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the event columns that the tally reads."""

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the state of the discs at time edges[0]; edges: (B + 1,), times between the blocks."""

    def add(self, rows: Any) -> None:
        """Add the next event rows of the log."""

    def finish(self) -> None:
        """Add the last part of the flight of every disc, up to time edges[-1]."""


def stream(
    log: Log,
    edges: np.ndarray,
    tallies: Iterable[Tally],
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Pass the events after time edges[0] and up to edges[-1] to all tallies.

    Velocities are relative to the centre of mass along axes where momentum is conserved. progress(done, total) is
    called with the number of rows read and the number of all rows.
    """
    frame = drift(log)
    state = log.state_at(edges[0])
    gas = replace(log.discs, position=state.position, velocity=state.velocity - frame)
    tallies = list(tallies)
    columns = tuple(dict.fromkeys(name for tally in tallies for name in tally.columns))
    for tally in tallies:
        tally.begin(gas, edges)
    first, last = log.row_at(edges[0], "right"), log.row_at(edges[-1], "right")
    done = 0
    for rows in log.chunks(columns, first, last):
        if frame.any() and "velocity" in columns:
            rows = rows._replace(velocity=rows.velocity - frame)
        for tally in tallies:
            tally.add(rows)
        done += len(rows[0])
        if progress is not None:
            progress(done, last - first)
    for tally in tallies:
        tally.finish()


@inline
def block_at(edges, block, time):
    """Index of the block that contains a time, searched forwards from a given block."""
    while block + 2 < edges.shape[0] and time > edges[block + 1]:
        block += 1
    return block


@inline
def block_back(edges, block, time):
    """Index of the block that contains a time, searched backwards from a given block."""
    while time < edges[block]:
        block -= 1
    return block
