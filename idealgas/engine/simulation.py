"""The simulation of a gas through the epochs of its run."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from idealgas.columns import EventBatch
from idealgas.effects.bundle import (
    Effects,
    begin_epoch,
    changed,
    end_epoch,
    energy_parts,
    for_kernels,
    next_change,
    present,
)
from idealgas.engine.diagnostics import Diagnostics, check_invariants
from idealgas.engine.epoch import driving_speed, encounters_of_effects, epoch_length, fall_along_sides
from idealgas.engine.method import Limits, Method
from idealgas.engine.records import COUNTERS, LATEST, UNLIMITED, Discs, InelasticCollapseError, synchronise
from idealgas.errors import UserError
from idealgas.physics import shear, stress
from idealgas.physics.exact_sum import SumRangeError, add_term
from idealgas.physics.periodic import Periodic, copy_of, periodic_axes
from idealgas.physics.steering import reversed_velocity
from idealgas.physics.stress import StressAccumulator
from idealgas.state import Gas

TRAJECTORY = 4
"""Version of the trajectories. Raise it by hand whenever a change to the program changes the log of a scene."""


class Stop(NamedTuple):
    """Limits of a run: a time and numbers of events. The run ends as soon as one of them is reached.

    Attributes:
        time: time since the start of the run.
        events: number of events since time 0.
        disc_collisions: number of collisions of two discs since time 0.
        trials: number of Monte Carlo trials since time 0.
    """

    time: float = LATEST
    events: int = UNLIMITED
    disc_collisions: int = UNLIMITED
    trials: int = UNLIMITED


NO_STOP = Stop()


class Totals(NamedTuple):
    """Numbers of events of a run since time 0.

    Attributes:
        events: all events that are logged.
        disc_collisions: collisions of two discs.
        wall_hits: collisions of discs with walls, including pistons.
        thermostat_collisions: collisions of discs with the heat bath.
        steered: discs whose velocity or acceleration was changed from outside.
        escaped: discs that have left the gas through absorbing walls; the final hit of each also counts as a wall hit.
        trials: pairs tried in the Monte Carlo method.
    """

    events: int = 0
    disc_collisions: int = 0
    wall_hits: int = 0
    thermostat_collisions: int = 0
    steered: int = 0
    escaped: int = 0
    trials: int = 0


def _nobody() -> np.ndarray:
    return np.empty(0, int)


@dataclass
class Simulation:
    """A gas that advances from event to event.

    The gas, the effects, the time and the totals at the start of an epoch determine everything that follows.

    Attributes:
        gas: the gas at the start of the epoch.
        method: method that finds the events; it cannot be shared with another simulation.
        effects: parameters and state of the effects; the simulation changes the state.
        time: time at the start of the epoch.
        epoch: number of the epoch, starting at 0.
        totals: numbers of events up to the start of the epoch.
        steered: ids of the discs whose velocity or acceleration was changed from outside at the start of the epoch.
    """

    gas: Gas
    method: Method
    effects: Effects = field(default_factory=Effects)
    time: float = 0.0
    epoch: int = 0
    totals: Totals = field(default_factory=Totals)
    steered: np.ndarray = field(default_factory=_nobody, init=False)

    def __post_init__(self) -> None:
        """Begin the first epoch."""
        self._encounters = encounters_of_effects(self.gas, self.effects)
        self.effects = changed(self.effects, 0.0, self.time)
        self._begin()

    def _begin(self) -> None:
        """Begin an epoch with the current gas, effects and time."""
        done, steered = self.totals, len(self.steered)
        self.totals = done._replace(events=done.events + steered, steered=done.steered + steered)
        until_change = next_change(self.effects, self.time) - self.time
        self.length = until_change
        if not self.method.single_epoch:
            thermostat = self.effects.thermostat
            bath_collisions = 0.0 if thermostat is None else len(self.gas) * thermostat.rate
            periodic, extra_speed = periodic_axes(self.effects.periodic), driving_speed(self.gas, self.effects)
            fall = fall_along_sides(self.effects)
            interacting = self.effects.noninteracting is None
            length = epoch_length(self.gas, self._encounters, extra_speed, periodic, bath_collisions, fall, interacting)
            self.length = min(length, until_change, shear.longest_epoch(self.effects.shear))
        begin_epoch(self.effects, self.time, self.length)
        self.method.start(self.gas, for_kernels(self.effects))
        self._counters = np.zeros(1, COUNTERS).view(np.recarray)
        self._counters["trials"] = self.totals.trials
        self.epoch_over = self.paused = False
        self._local_now = 0.0

    def advance(self, stop: Stop, batch: EventBatch | None, events: int = UNLIMITED, pause: float = LATEST) -> int:
        """Process events until the epoch is over, the stop is reached or the batch is full.

        Args:
            stop: end of the run.
            batch: memory for the rows of events; None to keep no log.
            events: largest number of events in this call.
            pause: time at which to return with `paused` set, unless the epoch or the run ends earlier; a pause changes
                no event.

        Returns:
            The number of rows filled.

        Raises:
            UserError: a disc collides endlessly at one instant, or a sum exceeds its range.
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
        except (InelasticCollapseError, SumRangeError) as error:
            raise self._dated(error) from error
        self.epoch_over, self.paused = arrived and end <= until_pause, arrived and until_pause <= end
        self._local_now = limits.until if arrived else self._counted()["time"]
        return rows

    def slices(
        self, stop: Stop, batch: EventBatch | None = None, events: int = UNLIMITED, pause: float = LATEST
    ) -> Iterator[int]:
        """Advance to the stop or the pause, through as many epochs as necessary.

        After each call of `advance`, yields the number of rows filled, which begin at the first row of the batch.
        """
        while not self.finished(stop):
            yield self.advance(stop, batch, events, pause)
            if self.paused:
                return
            if self.epoch_over and not self.finished(stop):
                self.next_epoch()

    def run(self, stop: Stop = NO_STOP, pause: float = LATEST) -> None:
        """Advance to the stop or the pause, through as many epochs as necessary, without a log."""
        for _ in self.slices(stop, pause=pause):
            pass

    def finished(self, stop: Stop) -> bool:
        """Whether the stop is reached and all rows up to it have been delivered."""
        if self.method.pending:
            return False
        done = self.counters
        if done.events >= stop.events or done.disc_collisions >= stop.disc_collisions or done.trials >= stop.trials:
            return True
        return self.epoch_over and self._local_now >= stop.time - self.time

    @property
    def counters(self) -> Totals:
        """Numbers of events from time 0 until now."""
        counted = self._counted()
        return Totals(
            self.totals.events + counted["events"],
            self.totals.disc_collisions + counted["disc_collisions"],
            self.totals.wall_hits + counted["wall_hits"],
            self.totals.thermostat_collisions + counted["thermostat_collisions"],
            self.totals.steered,
            0 if self.effects.absorbing is None else int(np.isnan(self.method.discs.record.x).sum()),
            counted["trials"],
        )

    def _counted(self) -> dict[str, Any]:
        """Counters of this epoch by name."""
        return dict(zip(COUNTERS.names or (), self._counters.item(), strict=True))

    @property
    def last_event_time(self) -> float:
        """Time of the last event of the epoch, or of the epoch's start if there was none."""
        return self.time + self._counted()["time"]

    @property
    def reached(self) -> float:
        """Time at which the last `advance` ended: the time limit or, if this was not reached, the last event."""
        return self.time + self._local_now

    def state(self) -> tuple[Gas, Effects]:
        """Return the gas and the effects at the time reached; images and momentum flow are copies."""
        periodic, flow = copy_of(self.effects.periodic), stress.copy_of(self.effects.flow)
        record = self.method.discs.record
        moved: Any = np.array(record.view(np.uint8)).view(record.dtype)  # copying bytes is seven times as fast
        discs = self.method.discs._replace(record=moved)
        gas = self._synchronised(discs, self._local_now, periodic, flow)
        return gas, self.effects._replace(periodic=periodic, flow=flow)

    def _dated(self, error: Exception) -> UserError:
        """Add the time of the last event to the error of a kernel, which cannot format the time itself."""
        return UserError(f"after t = {self.last_event_time:g}: {error}")

    def _synchronised(
        self, discs: Discs, local_time: float, periodic: Periodic | None, flow: StressAccumulator | None
    ) -> Gas:
        """Bring records, images and momentum flow to a local time, and return the gas at that time."""
        position, velocity = np.empty((2, len(discs.record), 2))
        try:
            gravity, absorbing = self.effects.gravity, self.effects.absorbing
            synchronise(discs, local_time, gravity, periodic, flow, absorbing, position, velocity)
        except SumRangeError as error:
            raise self._dated(error) from error
        if not self.method.has_positions:
            position = self.gas.position
        return replace(self.gas, position=position, velocity=velocity)

    def next_epoch(self) -> None:
        """Move all discs to the end of the epoch and begin the next one there."""
        self._end_epoch()
        self._begin()

    def reverse(self) -> None:
        """End the epoch at the time reached (`epoch_over` must be set), and reverse all velocities."""
        self._end_epoch()
        self._reverse()
        self._begin()

    def set_velocities(self, discs: np.ndarray, velocity: np.ndarray) -> None:
        """End the epoch at the time reached (`epoch_over` must be set), and give discs (n,) new velocities (n, 2)."""
        self._end_epoch()
        velocities = self.gas.velocity.copy()
        velocities[discs] = velocity
        before, after = self.gas.velocity.T, velocities.T
        given = 0.5 * self.gas.mass * ((after - before) * (after + before)).sum(axis=0)
        add_term(self.effects.step_energy, float(given.sum()))
        self._steer(np.flatnonzero((before != after).any(axis=0)), velocities)
        self._begin()

    def reschedule(self, schedule: Any) -> None:
        """End the epoch at the time reached (`epoch_over` must be set), and replace the schedule of later changes."""
        self.effects = self.effects._replace(schedule=schedule)
        self._end_epoch()
        self._begin()

    def _end_epoch(self) -> None:
        """Move all discs to the time reached, and apply the scheduled changes up to that time."""
        self.length = self._local_now
        self.gas = self._synchronised(self.method.discs, self.length, self.effects.periodic, self.effects.flow)
        self.totals = self.counters
        self.steered = _nobody()
        end_epoch(self.effects, self.length)
        self._change(self.time + self.length)
        self.time += self.length
        self.epoch += 1

    def _change(self, time: float) -> None:
        """Apply the scheduled changes up to a time, and record the energy that they give to the gas."""
        if next_change(self.effects, self.time) > time:
            return
        before, gravity = sum(energy_parts(self.effects, self.gas).values()), self.effects.gravity
        self.effects = changed(self.effects, self.time, time)
        if self.effects.step_energy is not None:
            add_term(self.effects.step_energy, sum(energy_parts(self.effects, self.gas).values()) - before)
        if self.effects.gravity is not gravity:
            self._steer(np.arange(len(self.gas)), self.gas.velocity)
        if any(self.time < reversal <= time for reversal in self.effects.steering or ()):
            self._reverse()

    def _reverse(self) -> None:
        """Reverse all velocities, between two epochs."""
        for effect, state in present(self.effects):
            effect.reverse(state)
        self._steer(np.arange(len(self.gas)), reversed_velocity(self.gas.velocity))

    def _steer(self, discs: np.ndarray, velocity: np.ndarray) -> None:
        """Set all velocities (N, 2) between two epochs, and mark the discs (n,) as steered unless they have left."""
        if self.effects.absorbing is not None:
            discs = discs[~np.isnan(self.gas.position[discs, 0])]
        self.gas, self.steered = replace(self.gas, velocity=velocity), np.union1d(self.steered, discs)

    def check_invariants(self) -> Diagnostics:
        """Return the conserved quantities and overlaps at the start of the epoch."""
        return self._check(self.gas, self.time)

    def check_invariants_of(self, gas: Gas) -> Diagnostics:
        """Return the conserved quantities and overlaps of a gas that `state` returned."""
        return self._check(gas, self.reached)

    def _check(self, gas: Gas, time: float) -> Diagnostics:
        effects = self.effects._replace(shear=shear.at(self.effects.shear, time))
        overlap = self.method.deepest_overlap(gas, effects)
        return check_invariants(gas, overlap, effects.absorbing, periodic_axes(effects.periodic))
