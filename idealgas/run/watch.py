"""What a run looks at as it goes: epochs in which nothing happens, and discs that keep it busy."""

import math

import numpy as np

from idealgas.engine.epoch import EVENTS_PER_DISC, FEWEST_EVENTS
from idealgas.engine.simulation import Simulation, Stop

EMPTY_EPOCHS = 10_000
"""So many epochs in a row without an event end a run that has no end in time.

Kinetic theory expects 4 events a disc or more in every epoch.
"""

QUIET_SAMPLES = 64
"""So many epochs in a row without an event have a sample; those after them have none."""

OVERDUE = 8
"""So many times the most events that an epoch is made for, and the run looks whose they are."""


class Watch:
    """Epochs in a row without an event, and how many events there were at the last checkpoint."""

    def __init__(self, simulation: Simulation, begun: bool) -> None:
        """Begin at the start of an epoch; begun: whether a checkpoint of it is there already."""
        self._simulation = simulation
        self._events_at_checkpoint = simulation.totals.events if begun else -1
        self._empty = 0
        self._told = False

    def end_epoch(self) -> None:
        """Take note of the epoch that is over, before the next one begins."""
        happened = self._simulation.counters.events > self._simulation.totals.events
        self._empty = 0 if happened else self._empty + 1

    def checkpoint_due(self, every: int) -> bool:
        """Whether the start of this epoch is to be kept: every so many epochs, if anything has happened since."""
        simulation = self._simulation
        due = simulation.epoch % every == 0 and simulation.totals.events > self._events_at_checkpoint
        if due:
            self._events_at_checkpoint, self._empty = simulation.totals.events, 0
        return due

    @property
    def sample_due(self) -> bool:
        """Whether the start of this epoch is to have a sample."""
        return self._empty < QUIET_SAMPLES

    def in_vain(self, stop: Stop) -> bool:
        """Whether the run is to end, as the events that its stop needs do not come."""
        return self._empty >= EMPTY_EPOCHS and stop.time == Stop().time and stop.trials == Stop().trials

    def busy(self) -> str:
        """One line, once, if few discs make most of the events of an epoch that has far too many; else empty."""
        simulation, n = self._simulation, len(self._simulation.gas)
        events = simulation.counters.events - simulation.totals.events
        too_many = OVERDUE * max(EVENTS_PER_DISC * n, FEWEST_EVENTS)
        if self._told or simulation.method.single_epoch or events <= too_many:
            return ""
        share = np.cumsum(np.sort(simulation.method.discs.record.count)[::-1], dtype=float)
        few = int(share.searchsorted(share[-1] / 2, "right")) + 1
        if share[-1] == 0 or few > math.ceil(n / 4):
            return ""
        self._told = True
        span = f"from t = {simulation.time:g} to t = {simulation.last_event_time:g}"
        return f"{few} of {n} discs make{'s' * (few == 1)} most of the events {span}"
