"""Running a scene: places the discs, simulates them with its method, and writes every event to a log."""

import math
import os
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from idealgas.columns import EventBatch
from idealgas.effects.bundle import Effects
from idealgas.engine.brute_force import BruteForce
from idealgas.engine.diagnostics import Diagnostics
from idealgas.engine.event_driven.method import EventDriven, expected_threads
from idealgas.engine.method import Method, Threads
from idealgas.engine.monte_carlo import MonteCarlo
from idealgas.engine.multiprecision import PreciseBruteForce
from idealgas.engine.records import LATEST, UNLIMITED
from idealgas.engine.simulation import TRAJECTORY, Simulation, Stop
from idealgas.engine.time_driven import TimeDriven
from idealgas.errors import UserError
from idealgas.initial.build import make_gas
from idealgas.jit import compile_seconds
from idealgas.log import LogWriter
from idealgas.log.summary import Summary
from idealgas.run.effects import make_effects
from idealgas.run.energy import Energy, energy_of
from idealgas.run.layout import by_name, disc_state, layout_of, observed, snapshot_state, whole_state
from idealgas.run.stall import STUCK, StallDetector
from idealgas.scene import Run, Scene
from idealgas.scene.defaults import reference_speed
from idealgas.state import Gas
from idealgas.toml.dump import dump_document

ONE_WAS_FASTER = "one was faster: few events, a busy machine, or a log that needs a core"
"""Why no slice was shared although several threads were available."""

SHORTEST_SLICE, LONGEST_SLICE = 0.05, 0.2  # seconds between reports of progress and checks for interruption


@dataclass(frozen=True)
class Progress:
    """Progress of a run.

    Attributes:
        share: fraction done, 0 to 1.
        time: time of the last event.
        events: number of events so far.
        notice: one line for the user, given once; usually empty.
    """

    share: float
    time: float
    events: int
    notice: str = ""


def stop_of(scene: Scene, n: int) -> Stop:
    """Stop rules of a scene with n discs."""
    run = scene.run
    collisions = run.collisions_per_disc and min(math.ceil(run.collisions_per_disc * n / 2), UNLIMITED)
    given: dict[str, Any] = {
        "time": run.until,
        "events": run.events,
        "disc_collisions": collisions,
        "trials": run.trials,
    }
    return Stop(**{name: limit for name, limit in given.items() if limit is not None})


def method_of(scene: Scene, start: Gas, v_ref: float | None = None) -> Method:
    """Method of a scene; start: its discs at time 0; v_ref: raised reference speed of a resumed run, length/time."""
    run = scene.run
    if run.method == "brute_force":
        return PreciseBruteForce(run.precision) if run.precision in ("float32", "double-double") else BruteForce()
    if run.method == "time_driven":
        return TimeDriven(run.dt or math.nan)
    if run.method == "monte_carlo":
        v_ref = v_ref or reference_speed(run, float(np.hypot(*start.velocity.T).max()))
        return MonteCarlo(scene.scene.seed, v_ref, one_sided=run.impact == "one_sided", rises=run.v_ref is None)
    return EventDriven(threads=_threads(run))


def _threads(run: Run) -> int | None:
    """Number of threads of a scene; None for as many as are worthwhile."""
    return None if run.threads == "auto" else run.threads


def threads_of(scene: Scene, gas: Gas) -> Threads:
    """Threads that will share the work of a run; gas: the discs at time 0."""
    if scene.run.method != "event_driven":
        return Threads()
    return expected_threads(gas, _threads(scene.run), scene.properties.local)


def simulate(
    scene: Scene,
    path: str | os.PathLike[str],
    *,
    force: bool = False,
    command: str = "",
    on_progress: Callable[[Progress], None] = lambda progress: None,
    interrupted: Callable[[], bool] = lambda: False,
    on_events: Callable[[EventBatch], None] | None = None,
) -> Summary:
    """Run a scene to the end that its table [run] asks for, and write its log.

    The first run with a set of effects compiles its machine code, which takes some seconds and is cached on disk.

    Args:
        scene: from `load_scene` or `parse_scene`.
        path: path of the log to write, an HDF5 file that `open_log` reads.
        force: whether to overwrite an existing log.
        command: command of the run, stored in the log.
        on_progress: called several times per second with the `Progress` of the run.
        interrupted: called as often; once it returns True, the run ends after its last event, and the summary has
            `completed` False. The log can then be read and resumed, as after Ctrl-C (KeyboardInterrupt).
        on_events: called with the next rows of the log, in order, which it may use until it returns; the run waits.

    Raises:
        SceneError: if the discs cannot be placed.
        OutputError: if the log exists (without `force`), cannot be written, or is removed during the run.
        UserError: in an inelastic collapse, or if the events that would end the run do not occur (see
            `idealgas.run.stall`); the log can be read and resumed.
    """
    compiled_before = compile_seconds()
    gas = make_gas(scene)
    effects = make_effects(scene, gas)
    method = method_of(scene, gas)
    with LogWriter(
        path,
        gas,
        layout_of(scene, gas, effects, method.has_positions, method.extra_state),
        scene_text=dump_document(scene),
        seed=scene.scene.seed,
        command=command,
        trajectory=TRAJECTORY,
        fsync=scene.log.fsync,
        force=force,
    ) as log:
        past = RunHistory(energy_of(gas, effects))
        return LoggedRun(scene, Simulation(gas, method, effects), log, past, compiled_before, on_events).run(
            on_progress, interrupted
        )


def warm_up(scene: Scene) -> float:
    """Compile the machine code of a scene and return the seconds it took; almost none if it was cached.

    The scene runs up to its first event, and its log is deleted. Raises the same errors as `simulate`.
    """
    first = {"events": 1, "collisions_per_disc": None, "trials": None}
    short = scene.model_copy(update={"run": scene.run.model_copy(update=first)})
    with tempfile.TemporaryDirectory(prefix="idealgas-warm-up-") as folder:
        return simulate(short, Path(folder) / "run.h5").compile_seconds


class RunHistory(NamedTuple):
    """Past of a run: energy at time 0, largest overlap and distance outside, number of snapshots, whether it began."""

    start_energy: Energy
    overlap: float = 0.0
    outside: float = 0.0
    snapshots: int = 0
    begun: bool = False


class LoggedRun:
    """A simulation and its log on the way to a stop; compiled_before: `compile_seconds` before either was made."""

    def __init__(
        self,
        scene: Scene,
        simulation: Simulation,
        log: LogWriter,
        past: RunHistory,
        compiled_before: float,
        on_events: Callable[[EventBatch], None] | None = None,
    ) -> None:
        self._scene = scene
        self._simulation = simulation
        self._log = log
        self._compiled_before = compiled_before
        self._on_events = on_events
        self._stop = stop_of(scene, len(simulation.gas))
        self._start_energy, self._overlap, self._outside, self._snapshots, self._begun = past
        self._stall = StallDetector(simulation, self._stop, self._begun)
        self._extra_state = dict(simulation.method.extra_state)

    def run(self, on_progress: Callable[[Progress], None], interrupted: Callable[[], bool]) -> Summary:
        """Simulate to the stop, or until `interrupted` returns True, and close the log; UserError if it stalls."""
        simulation, stop = self._simulation, self._stop
        if not self._begun:
            if self._scene.log.snapshot_every:
                self._snapshot()
            self._begin_epoch()
        self._slice(0)  # compiles, before the clock starts
        started = time.perf_counter()
        least = simulation.method.threads.min_events
        slice_events = max(4096, least)
        while not simulation.finished(stop):
            before = time.perf_counter()
            alone = simulation.method.threads.serial_events if self._log.behind else 0  # the log needs a core
            self._slice(alone or slice_events)
            if simulation.paused and self._scene.log.snapshot_every:  # not at the largest representable time
                self._snapshot()
            if (disc := self._stall.stuck()) >= 0:
                self._log.close()
                raise UserError(
                    f"{self._log.path}: disc {disc} is stuck at t = {simulation.last_event_time:g}: "
                    f"more than {STUCK} collisions per contact duration; the log can be read"
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
                slice_events = min(2 * slice_events, UNLIMITED)
            elif taken > LONGEST_SLICE:
                slice_events = max(slice_events // 2, least)
        summary = self._finish(time.perf_counter() - started)
        self._log.close(summary.as_dict() if summary.completed else None)
        return summary

    def _slice(self, events: int) -> None:
        """Advance by at most `events` events and write their rows to the log."""
        simulation = self._simulation
        if self._scene.log.events:
            self._advance(events)
            while simulation.method.pending:
                self._advance(events)
        else:
            simulation.advance(self._stop, None, events, self._next_snapshot)
        if self._extra_state != simulation.method.extra_state:
            self._extra_state = dict(simulation.method.extra_state)
            gas, effects = simulation.state()
            self._observe(simulation.last_event_time, gas, effects, simulation.check_invariants_of(gas))

    def _advance(self, events: int) -> None:
        """Advance by at most `events` events and write the rows that fit into a buffer of the log."""
        batch = self._log.batch()
        rows = self._simulation.advance(self._stop, batch, events, self._next_snapshot)
        if self._on_events is not None and rows:
            self._on_events(batch.rows(0, rows))
        self._log.write(rows)

    @property
    def _next_snapshot(self) -> float:
        every = self._scene.log.snapshot_every
        return self._snapshots * every if every else LATEST

    def _snapshot(self) -> None:
        """Store a snapshot of the discs, and a sample unless an epoch begins here, which has one."""
        simulation, time = self._simulation, self._next_snapshot
        gas, effects = simulation.state()
        state = by_name(snapshot_state(gas, effects, simulation.method.has_positions))
        if time > simulation.time and not simulation.epoch_over:
            self._observe(time, gas, effects, simulation.check_invariants_of(gas))
        self._log.snapshot(time, self._snapshots, state)
        self._snapshots += 1

    def _begin_epoch(self) -> None:
        """Check the invariants at the start of an epoch, and store a checkpoint if events have occurred.

        Raises:
            UserError: if the run stalls; the log is closed before.
        """
        simulation, stall = self._simulation, self._stall
        reason = stall.stall_reason()
        if stall.sample_due or reason:
            self._observe(simulation.time, simulation.gas, simulation.effects, simulation.check_invariants())
        if stall.checkpoint_due(self._scene.log.checkpoint_every) or reason:
            self._checkpoint()
        if reason:
            self._log.close()
            raise UserError(
                f"{self._log.path}: {reason}, up to t = {simulation.time:g}, so the end of the run may never come; "
                "the log can be read, and resumed (--until gives it an end in time)"
            )

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

    def _finish(self, seconds: float) -> Summary:
        """Check the invariants of the final state and return the summary of the run."""
        simulation, stop = self._simulation, self._stop
        ended_by_time = simulation.epoch_over and stop.time < LATEST
        end_time = stop.time if ended_by_time else simulation.reached
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
            seconds=seconds,
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
