"""A run in progress, with its log."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, NoReturn

import numpy as np

from idealgas.columns import EventBatch
from idealgas.effects.bundle import Effects
from idealgas.engine.diagnostics import Diagnostics
from idealgas.engine.records import LATEST, UNLIMITED
from idealgas.engine.simulation import Simulation, Stop
from idealgas.errors import UserError
from idealgas.jit import compile_seconds
from idealgas.log import LogWriter
from idealgas.log.summary import Summary
from idealgas.run.energy import Energy, energy_of
from idealgas.run.layout import by_name, disc_state, observed, snapshot_state, whole_state, write_steered
from idealgas.run.stall import STUCK, StallDetector
from idealgas.scene import Scene
from idealgas.state import Gas
from idealgas.system import free_unused_memory

ONE_WAS_FASTER = "one thread was faster: few events, a busy machine, or a log that needs a core"
"""Reason why no slice was shared although several threads were available."""

SHORTEST_SLICE, LONGEST_SLICE = 0.05, 0.2  # seconds between reports of progress and checks for interruption


@dataclass(frozen=True)
class Progress:
    """Progress of a run.

    Attributes:
        share: fraction done, 0 to 1.
        time: time of the last event.
        events: number of events so far.
        notice: a line for the user, which appears only once; usually empty.
    """

    share: float
    time: float
    events: int
    notice: str = ""


def stop_of(scene: Scene, n: int) -> Stop:
    """Return the stop rules of a scene with n discs."""
    run = scene.run
    collisions = run.collisions_per_disc and min(math.ceil(run.collisions_per_disc * n / 2), UNLIMITED)
    given: dict[str, Any] = {
        "time": run.until,
        "events": run.events,
        "disc_collisions": collisions,
        "trials": run.trials,
    }
    return Stop(**{name: limit for name, limit in given.items() if limit is not None})


class RunHistory(NamedTuple):
    """History of a run up to the point at which it begins or is resumed.

    Attributes:
        start_energy: energy account at time 0.
        overlap: deepest overlap of two discs, divided by the sum of their radii.
        outside: largest distance by which a disc protruded beyond a side, divided by the diameter of the disc.
        snapshots: number of snapshots.
        begun: whether the log already contains the start of the run.
    """

    start_energy: Energy
    overlap: float = 0.0
    outside: float = 0.0
    snapshots: int = 0
    begun: bool = False


class LoggedRun:
    """A run and its log, up to the end of the scene.

    Attributes:
        summary: summary of the run; None until it is finished.
    """

    summary: Summary | None = None

    def __init__(
        self,
        scene: Scene,
        simulation: Simulation,
        log: LogWriter,
        past: RunHistory,
        compiled_before: float,
        on_events: Callable[[EventBatch], None] | None = None,
    ) -> None:
        """Begin with a simulation and its log; compiled_before: value of `compile_seconds` before these were made."""
        self._scene = scene
        self._simulation = simulation
        self._log = log
        self._compiled_before = compiled_before
        self._on_events = on_events
        self._stop = self._goal = stop_of(scene, len(simulation.gas))
        self._start_energy, self._overlap, self._outside, self._snapshots, self._begun = past
        self._stall = StallDetector(simulation, self._stop, self._begun)
        self._extra_state = dict(simulation.method.extra_state)
        self._slice_events, self._seconds = 0, 0.0

    def finish(
        self,
        on_progress: Callable[[Progress], None] = lambda progress: None,
        interrupted: Callable[[], bool] = lambda: False,
    ) -> Summary:
        """Simulate to the end of the scene, or until `interrupted` returns True, and close the log.

        Raises:
            UserError: as in `simulate`.
        """
        self._advance(self._stop, on_progress, interrupted)
        self.summary = self._summarise()
        self._log.close(self.summary.as_dict() if self.summary.completed else None)
        return self.summary

    def _advance(
        self,
        stop: Stop,
        on_progress: Callable[[Progress], None] = lambda progress: None,
        interrupted: Callable[[], bool] = lambda: False,
    ) -> None:
        """Simulate to a stop, or until `interrupted` returns True; UserError if the run stalls."""
        simulation, self._goal = self._simulation, stop
        least = simulation.method.threads.min_events
        if not self._slice_events:
            self._begin(least)
        started = time.perf_counter()
        while not simulation.finished(stop):
            before = time.perf_counter()
            alone = simulation.method.threads.serial_events if self._log.behind else 0  # leave a core to the log
            self._slice(alone or self._slice_events)
            if simulation.paused and self._scene.log.snapshot_every:  # without snapshots, only LATEST is a pause
                self._snapshot()
            if (disc := self._stall.stuck()) >= 0:
                self._log.close()
                raise UserError(
                    f"{self._log.path}: disc {disc} is stuck at t = {simulation.last_event_time:g}: "
                    f"more than {STUCK} collisions within one contact duration; the log can still be read"
                )
            if simulation.epoch_over and not simulation.finished(stop):
                self._stall.end_epoch()
                simulation.next_epoch()
                self._begin_epoch()
            on_progress(self._progress())
            if interrupted():
                break
            taken = time.perf_counter() - before
            if taken < SHORTEST_SLICE and not (alone or simulation.paused):
                self._slice_events = min(2 * self._slice_events, UNLIMITED)
            elif taken > LONGEST_SLICE:
                self._slice_events = max(self._slice_events // 2, least)
        self._seconds += time.perf_counter() - started

    def _begin(self, least: int) -> None:
        """Store the initial state of a new run, and compile before timing starts; least: fewest events in a slice."""
        self._slice_events = max(4096, least)
        if not self._begun:
            if self._scene.log.snapshot_every:
                self._snapshot()
            self._begin_epoch()
        elif reason := self._stall.stall_reason():
            self._give_up(reason)
        self._slice(0)

    def _slice(self, events: int) -> None:
        """Advance by at most `events` events and write their rows to the log."""
        simulation = self._simulation
        if self._scene.log.events:
            self._fill(events)
            while simulation.method.pending:
                self._fill(events)
        else:
            simulation.advance(self._goal, None, events, self._next_snapshot)
        if self._extra_state != simulation.method.extra_state:
            self._extra_state = dict(simulation.method.extra_state)
            gas, effects = simulation.state()
            self._observe(simulation.last_event_time, gas, effects, simulation.check_invariants_of(gas))

    def _fill(self, events: int) -> None:
        """Advance by at most `events` events and write the rows that fit into a buffer of the log."""
        batch = self._log.batch()
        self._write(batch, self._simulation.advance(self._goal, batch, events, self._next_snapshot))

    def _write(self, batch: EventBatch, rows: int, held: bool = False) -> None:
        """Write the first `rows` rows of a buffer of the log; held: see `LogWriter.write`."""
        self._log.write(rows, held)
        if self._on_events is not None and rows:
            self._on_events(batch.rows(0, rows))

    @property
    def _next_snapshot(self) -> float:
        every = self._scene.log.snapshot_every
        return self._snapshots * every if every else LATEST

    def _snapshot(self) -> None:
        """Store a snapshot of the discs, and also a sample, unless an epoch that begins now stores one anyway."""
        simulation, time = self._simulation, self._next_snapshot
        gas, effects = simulation.state()
        state = by_name(snapshot_state(gas, effects, simulation.method.has_positions))
        if time > simulation.time and not simulation.epoch_over:
            self._observe(time, gas, effects, simulation.check_invariants_of(gas))
        self._log.snapshot(time, self._snapshots, state)
        self._snapshots += 1

    def _begin_epoch(self, changed: bool = False) -> None:
        """Check the invariants at the start of an epoch, and store a sample and a checkpoint if they are due.

        Raises:
            UserError: the run stalls; the log is closed first.
        """
        simulation, stall = self._simulation, self._stall
        self._log_steered(changed)
        reason = stall.stall_reason()
        if stall.sample_due or reason or changed:
            self._observe(simulation.time, simulation.gas, simulation.effects, simulation.check_invariants())
        if stall.checkpoint_due(self._scene.log.checkpoint_every) or reason or changed:
            self._checkpoint()
        if reason:
            self._give_up(reason)

    def _give_up(self, reason: str) -> NoReturn:
        """Close the log of a run that stalls, and raise UserError."""
        self._log.close()
        raise UserError(
            f"{self._log.path}: {reason}, up to t = {self._simulation.time:g}, so the run may never end; "
            "the log can be read and resumed (use --until to set an end time)"
        )

    def _log_steered(self, changed: bool) -> None:
        """Write the rows of the discs whose velocities were changed at the start of this epoch.

        changed: whether a program changed them, which `resume` cannot repeat.
        """
        ids = self._simulation.steered
        while len(ids) and self._scene.log.events:
            batch = self._log.batch()
            discs, ids = np.split(ids, [len(batch.time) - 1])
            write_steered(batch, discs, self._simulation)
            self._write(batch, len(discs), held=changed)

    def _checkpoint(self) -> None:
        """Store the state at the start of an epoch."""
        simulation = self._simulation
        state = by_name(disc_state(simulation.gas, simulation.effects, simulation.method.has_positions))
        whole = by_name(whole_state(simulation.effects)) | by_name(simulation.method.extra_state)
        self._log.checkpoint(simulation.time, simulation.epoch, state, simulation.totals._asdict() | whole)

    def _observe(self, time: float, gas: Gas, effects: Effects, diagnostics: Diagnostics) -> None:
        self._overlap = max(self._overlap, diagnostics.overlap)
        self._outside = max(self._outside, diagnostics.outside)
        simulation = self._simulation
        sample = by_name(observed(gas, effects, time - simulation.time)) | by_name(self._extra_state)
        self._log.observe(time, simulation.epoch, diagnostics._asdict() | simulation.counters._asdict() | sample)

    def _summarise(self) -> Summary:
        """Check the invariants of the final state and return the summary of the run."""
        simulation, stop = self._simulation, self._stop
        ended_by_time = simulation.epoch_over and stop.time < LATEST
        end_time = stop.time if ended_by_time else simulation.reached
        free_unused_memory()
        gas, effects = simulation.state()
        self._observe(end_time, gas, effects, simulation.check_invariants_of(gas))
        start, end = self._start_energy, energy_of(gas, effects, end_time - simulation.time)
        drift = (end.balance - start.balance) / (max(start.scale, end.scale) or 1.0)
        totals, threads = simulation.counters, simulation.method.threads
        if not threads.slices and threads.number > 1:
            threads = threads._replace(number=1, reason=ONE_WAS_FASTER)
        return Summary(
            completed=simulation.finished(stop),
            end_time=end_time,
            **totals._asdict(),
            rows=totals.events + totals.disc_collisions,
            epochs=simulation.epoch + 1,
            energy_change=end.gas - start.gas,
            energy_drift=drift,
            deepest_overlap=self._overlap,
            max_wall_penetration=self._outside,
            seconds=self._seconds,
            compile_seconds=compile_seconds() - self._compiled_before,
            threads=threads.number,
            threads_reason=threads.reason,
            shared_slices=threads.slices,
            aborted_slices=threads.aborted,
        )

    def _progress(self) -> Progress:
        done, stop = self._simulation.counters, self._stop
        now = self._simulation.last_event_time
        counted = (done.events / stop.events, done.disc_collisions / stop.disc_collisions, done.trials / stop.trials)
        return Progress(max(now / stop.time, *counted), now, done.events, self._stall.busy())
