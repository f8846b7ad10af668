"""A gas on its way through the epochs of its run."""

import copy
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Protocol

import numpy as np

from idealgas.engine.audit import Audit, audit
from idealgas.engine.epoch import encounters_per_length, epoch_length, speed_beyond
from idealgas.engine.records import COUNTERS, LATEST, UNLIMITED, Discs, EventCascadeError, Limits, synchronise
from idealgas.errors import UserError
from idealgas.events import EventBatch
from idealgas.gas.state import Gas
from idealgas.physics.effects import Effects, begin_epoch, end_epoch, next_change
from idealgas.physics.periodic import Periodic, copy_of, periodic_axes

TRAJECTORY = 3
"""Version of the laws of motion, raised by hand whenever a log of before would go on otherwise than it began."""


class Method(Protocol):
    """What the epochs ask of a method.

    homogeneous: its discs have no positions; those of the gas stay as they are. single_epoch: it has digits that would
    be lost between epochs.
    """

    discs: Discs
    without_positions: bool
    single_epoch: bool

    def start(self, gas: Gas, effects: Effects) -> None: ...

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]: ...

    def deepest_overlap(self) -> float: ...


class Stop(NamedTuple):
    """Where a run ends, whichever comes first. time: time. events, disc_collisions, trials: numbers since time 0."""

    time: float = LATEST
    events: int = UNLIMITED
    disc_collisions: int = UNLIMITED
    trials: int = UNLIMITED


NO_STOP = Stop()


@dataclass
class Totals:
    """What happened since time 0, up to the start of the epoch. trials: of pairs, by Monte Carlo."""

    events: int = 0
    disc_collisions: int = 0
    wall_hits: int = 0
    trials: int = 0


@dataclass
class Simulation:
    """Advances a gas by events; all of it follows from gas, effects, time and totals at the start of an epoch.

    gas: at the start of the epoch. method: a fresh method. effects: with their state, which the simulation changes.
    time: of the start of the epoch.
    """

    gas: Gas
    method: Method
    effects: Effects = field(default_factory=Effects)
    time: float = 0.0
    epoch: int = 0
    totals: Totals = field(default_factory=Totals)

    def __post_init__(self) -> None:
        self._encounters = encounters_per_length(self.gas, periodic_axes(self.effects.periodic))
        self._begin()

    def _begin(self) -> None:
        begin_epoch(self.effects, self.time)
        until_change = next_change(self.effects, self.time) - self.time
        self.length = until_change
        if not self.method.single_epoch:
            periodic, extra_speed = periodic_axes(self.effects.periodic), speed_beyond(self.gas, self.effects)
            self.length = min(epoch_length(self.gas, self._encounters, extra_speed, periodic), until_change)
        self.method.start(self.gas, self.effects)
        self.overlap = self.method.deepest_overlap()
        self._counters = np.zeros(1, COUNTERS).view(np.recarray)
        self._counters[0].trials = self.totals.trials
        self.epoch_over = self.paused = False
        self._local_now = 0.0

    def advance(self, stop: Stop, batch: EventBatch | None, events: int = UNLIMITED, pause: float = LATEST) -> int:
        """Process events until the epoch is over, the stop is reached or the batch is full; return the rows filled.

        events: a further limit for this call. pause: time at which to return with `paused` set, unless it is later
        than the end of the epoch or the stop; it changes no event. UserError if the clock stands still.
        """
        done = self.counters
        end = min(self.length, stop.time - self.time, LATEST)
        until_pause = min(pause - self.time, self.length) if pause <= self.time + self.length else LATEST
        limits = Limits(
            min(end, until_pause),
            min(stop.events - done.events, events),
            stop.disc_collisions - done.disc_collisions,
            stop.trials - done.trials,
        )
        try:
            rows, arrived = self.method.advance(limits, self.time, batch, self._counters)
        except EventCascadeError as error:  # of a kernel, which cannot say when
            raise UserError(f"after t = {self.last_event_time:g}: {error}") from error
        self.epoch_over, self.paused = arrived and end <= until_pause, arrived and until_pause <= end
        self._local_now = limits.until if arrived else float(self._counters[0]["time"])
        return rows

    def slices(
        self, stop: Stop, batch: EventBatch | None = None, events: int = UNLIMITED, pause: float = LATEST
    ) -> Iterator[int]:
        """Advance to the stop or the pause through as many epochs as it takes; yield after each call of `advance` the
        rows it filled, from the first row of the batch.
        """
        while not self.finished(stop):
            yield self.advance(stop, batch, events, pause)
            if self.paused:
                return
            if self.epoch_over and not self.finished(stop):
                self.next_epoch()

    def run(self, stop: Stop = NO_STOP, pause: float = LATEST) -> None:
        """Advance to the stop or the pause through as many epochs as it takes, without rows."""
        for _ in self.slices(stop, pause=pause):
            pass

    def finished(self, stop: Stop) -> bool:
        """Whether the stop is reached."""
        done = self.counters
        if done.events >= stop.events or done.disc_collisions >= stop.disc_collisions or done.trials >= stop.trials:
            return True
        return self.epoch_over and self.length >= stop.time - self.time

    @property
    def counters(self) -> Totals:
        """What happened since time 0, up to now."""
        counter = self._counters[0]
        return Totals(
            self.totals.events + int(counter["events"]),
            self.totals.disc_collisions + int(counter["disc_collisions"]),
            self.totals.wall_hits + int(counter["wall_hits"]),
            int(counter["trials"]),
        )

    @property
    def last_event_time(self) -> float:
        """Time of the last event, or the epoch's start if there was none in it."""
        return self.time + float(self._counters[0]["time"])

    def state(self) -> tuple[Gas, Effects]:
        """The gas and the effects where the last call of `advance` left them: at its time limit, or at the last
        event before.

        The gas and its images are copies.
        """
        periodic = copy_of(self.effects.periodic)
        return self._synchronised(self._local_now, periodic), self.effects._replace(periodic=periodic)

    def _synchronised(self, local_time: float, periodic: Periodic | None) -> Gas:
        """The gas at a local time; the records stay as they are."""
        record, ids, _ = self.method.discs
        record = record.copy()
        synchronise(record, ids, local_time, self.effects.gravity, periodic)
        position, velocity = np.empty((2, len(record), 2))
        position[ids] = np.column_stack((record.x, record.y))
        velocity[ids] = np.column_stack((record.vx, record.vy))
        if self.method.without_positions:
            position = self.gas.position
        return replace(self.gas, position=position, velocity=velocity)

    def next_epoch(self) -> None:
        """Bring all discs to the end of the epoch and begin the next one there."""
        self.gas, self.totals = self._synchronised(self.length, self.effects.periodic), self.counters
        end_epoch(self.effects, self.length)
        self.time += self.length
        self.epoch += 1
        self._begin()

    def audit(self) -> Audit:
        """What must hold, at the start of the epoch."""
        return audit(self.gas, self.overlap)

    def audit_of(self, gas: Gas) -> Audit:
        """What must hold, of a gas that `state` gave."""
        method = copy.copy(self.method)
        method.start(gas, self.effects._replace(periodic=copy_of(self.effects.periodic)))
        return audit(gas, method.deepest_overlap())
