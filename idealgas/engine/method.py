"""The interface between a simulation and its method, the limits of a call, and the division of work among threads."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from idealgas.columns import Column, EventBatch
from idealgas.effects.bundle import Effects, for_kernels
from idealgas.engine.diagnostics import deepest_overlap
from idealgas.engine.records import Discs, make_discs
from idealgas.state import Gas


class Limits(NamedTuple):
    """Limits at which a call of an engine's kernel ends: a time and numbers of events.

    Attributes:
        until: latest local time of an event, time.
        events: largest number of events in this call.
        collisions: largest number of collisions of two discs in this call.
        trials: largest number of Monte Carlo trials in this call.
    """

    until: float
    events: int
    collisions: int
    trials: int


class Threads(NamedTuple):
    """How a method shares its work among threads, which does not affect the events.

    Attributes:
        number: number of threads.
        reason: reason for this number.
        slices: number of slices of time that several threads shared.
        aborted: number of these slices that one thread had to repeat.
        min_events: smallest number of events per call of `advance` that several threads can share.
        serial_events: largest number of events per call for which one thread works alone and leaves another core free;
            0 if a core is free anyway or none can be freed.
    """

    number: int = 1
    reason: str = "the method has one"
    slices: int = 0
    aborted: int = 0
    min_events: int = 1
    serial_events: int = 0


class Method(ABC):
    """A method of finding the events, with its state in the current epoch.

    Attributes:
        discs: records of the discs in the current epoch.
        has_positions: whether the method moves discs; if not, the positions of the gas remain unchanged.
        single_epoch: whether the run must be a single epoch, because precision would be lost between epochs.
    """

    discs: Discs
    has_positions = True
    single_epoch = False

    @property
    def pending(self) -> bool:
        """Whether `advance` still has rows of past events to deliver."""
        return False

    @property
    def threads(self) -> Threads:
        """How the work is shared among threads."""
        return Threads()

    @property
    def extra_state(self) -> Mapping[Column, float]:
        """Additional state on which later epochs depend, by column of the log; `advance` returns once it changes."""
        return {}

    def start(self, gas: Gas, effects: Effects) -> None:
        """Begin an epoch; the gas is at local time 0."""
        self.discs = make_discs(gas, np.arange(len(gas)))
        self._effects = effects

    @abstractmethod
    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Process events up to the limits, or until the batch is full.

        Returns the number of rows written, and whether all events up to the time limit have happened.
        """

    def deepest_overlap(self, gas: Gas, effects: Effects) -> float:
        """Return the deepest overlap of two discs over the sum of their radii; effects: effects at the gas's time."""
        if effects.noninteracting is not None:
            return 0.0  # such discs may overlap
        return deepest_overlap(gas, for_kernels(effects).periodic, effects.absorbing)
