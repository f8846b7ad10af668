"""One pass over the events of a log, in bounded memory, feeding any number of tallies.

A tally follows every disc from event to event, and adds up what the flights and the events contribute to each block of
time. Block edges split flights, so that time averages are exact. Shape of the sums: (B, …).
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from idealgas._jit import inline
from idealgas.analysis.core.equilibrium import drift
from idealgas.gas.state import Gas
from idealgas.log import Log


class Tally(Protocol):
    """What `stream` feeds."""

    @property
    def columns(self) -> tuple[str, ...]:
        """The event columns it reads."""

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Take the discs as they are at edges[0], and the edges (B + 1,) of the blocks."""

    def add(self, rows: Any) -> None:
        """Take further rows of the log."""

    def finish(self) -> None:
        """Bring every disc to edges[-1]."""


def stream(
    log: Log,
    edges: np.ndarray,
    tallies: Iterable[Tally],
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Feed the events after edges[0] up to edges[-1] to the tallies; progress(rows done, rows in all).

    Velocities are relative to the centre of mass where that moves on for ever.
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
    """Block of a time not before the given block's start."""
    while block + 2 < edges.shape[0] and time > edges[block + 1]:
        block += 1
    return block


@inline
def block_back(edges, block, time):
    """Block of a time not after the given block's end."""
    while time < edges[block]:
        block -= 1
    return block
