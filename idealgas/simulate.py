"""From a scene to a run: the discs, the method, the log, and where it stops."""

import math
import os
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass

from idealgas.engine.audit import Audit
from idealgas.engine.simulation import LATEST, METHODS, Simulation, Stop
from idealgas.gas import make_gas
from idealgas.log import Column, LogWriter, box_walls
from idealgas.scene import Scene, dump_scene

SHORTEST_SLICE, LONGEST_SLICE = 0.05, 0.2  # seconds between looks at the clock and at a request to stop

TOTALS = (Column("events", "i8"), Column("disc_collisions", "i8"), Column("wall_hits", "i8"))
OBSERVABLES = (
    Column("kinetic_energy", "f8", unit="energy"),
    Column("momentum", "f8", (2,), "mass length/time"),
    Column("overlap", "f8"),
    Column("outside", "f8"),
    *TOTALS,
)


@dataclass(frozen=True)
class Summary:
    """What a run came to.

    completed: whether it reached its end. end_time: time. energy_drift: relative. deepest_overlap: in units of the sum
    of the radii; farthest_outside: in units of a diameter (both at the starts of epochs and at the end). seconds: wall
    time, start-up and compilation not counted.
    """

    completed: bool
    end_time: float
    events: int
    disc_collisions: int
    wall_hits: int
    rows: int
    epochs: int
    energy_drift: float
    deepest_overlap: float
    farthest_outside: float
    seconds: float


@dataclass(frozen=True)
class Progress:
    """Where a run is. share: of the way to its end, 0 to 1. time: simulated time of the last event. events: so far."""

    share: float
    time: float
    events: int


def stop_of(scene: Scene, n: int) -> Stop:
    """Where the scene of n discs ends."""
    run = scene.run
    stop = Stop()
    if run.until is not None:
        stop = stop._replace(time=run.until)
    if run.events is not None:
        stop = stop._replace(events=run.events)
    if run.collisions_per_disc is not None:
        stop = stop._replace(disc_collisions=math.ceil(run.collisions_per_disc * n / 2))
    return stop


def simulate(
    scene: Scene,
    path: str | os.PathLike[str],
    *,
    force: bool = False,
    command: str = "",
    on_progress: Callable[[Progress], None] = lambda progress: None,
    interrupted: Callable[[], bool] = lambda: False,
) -> Summary:
    """Run a scene and write its log.

    force: replace an existing file. command: stored in the log. interrupted: asked several times a second; once true,
    the run ends at its last event, with a readable log. Raises SceneError if the discs do not fit, LogError if the log
    cannot be written.
    """
    gas = make_gas(scene)
    with LogWriter(
        path,
        gas,
        scene_text=dump_scene(scene),
        seed=scene.scene.seed,
        command=command,
        walls=box_walls(gas.box),
        events=scene.log.events,
        compression=scene.log.compression,
        force=force,
        checkpoint_values=TOTALS,
        observables=OBSERVABLES,
    ) as log:
        run = _Run(scene, Simulation(gas, METHODS[scene.run.method]()), log)
        return run.to_the_end(on_progress, interrupted)


class _Run:
    """A simulation and its log on the way to a stop."""

    def __init__(self, scene: Scene, simulation: Simulation, log: LogWriter) -> None:
        self._scene = scene
        self._simulation = simulation
        self._log = log
        self._stop = stop_of(scene, len(simulation.gas))
        self._start_energy = simulation.gas.kinetic_energy
        self._overlap = self._outside = 0.0

    def to_the_end(self, on_progress: Callable[[Progress], None], interrupted: Callable[[], bool]) -> Summary:
        simulation, stop = self._simulation, self._stop
        self._checkpoint()
        self._slice(0)  # compiles, before the clock starts
        started = time.perf_counter()
        slice_events = 4096
        while not simulation.finished(stop):
            before = time.perf_counter()
            self._slice(slice_events)
            if simulation.epoch_over and not simulation.finished(stop):
                simulation.next_epoch()
                self._checkpoint()
            on_progress(self._progress())
            if interrupted():
                break
            taken = time.perf_counter() - before
            if taken < SHORTEST_SLICE:
                slice_events *= 2
            elif taken > LONGEST_SLICE:
                slice_events = max(slice_events // 2, 1)
        summary = self._finish(time.perf_counter() - started)
        self._log.close(asdict(summary) if summary.completed else None)
        return summary

    def _slice(self, events: int) -> None:
        """Advance by at most so many events and hand their rows to the log."""
        if not self._scene.log.events:
            self._simulation.advance(self._stop, None, events)
            return
        batch = self._log.batch()
        rows = self._simulation.advance(self._stop, batch, events)
        self._log.write(batch, rows)

    def _checkpoint(self) -> None:
        """At the start of an epoch: audit, and store the state from which everything else can be rebuilt."""
        simulation = self._simulation
        self._observe(simulation.time, simulation.audit())
        if simulation.epoch % self._scene.log.checkpoint_every == 0:
            state = {"position": simulation.gas.position, "velocity": simulation.gas.velocity}
            self._log.checkpoint(simulation.time, simulation.epoch, state, asdict(simulation.totals))

    def _observe(self, time: float, audit: Audit) -> None:
        self._overlap = max(self._overlap, audit.overlap)
        self._outside = max(self._outside, audit.outside)
        self._log.observe(time, self._simulation.epoch, audit._asdict() | asdict(self._simulation.so_far))

    def _finish(self, seconds: float) -> Summary:
        """Audit the state at the end; the run may be continued from its last checkpoint as if it had not ended."""
        simulation, stop = self._simulation, self._stop
        ended_by_time = simulation.epoch_over and stop.time < LATEST
        end_time = stop.time if ended_by_time else simulation.last_event_time
        audit = simulation.audit_now()
        self._observe(end_time, audit)
        totals = simulation.so_far
        drift = audit.kinetic_energy / self._start_energy - 1.0 if self._start_energy > 0 else 0.0
        return Summary(
            completed=simulation.finished(stop),
            end_time=end_time,
            **asdict(totals),
            rows=2 * totals.disc_collisions + totals.wall_hits,
            epochs=simulation.epoch + 1,
            energy_drift=drift,
            deepest_overlap=self._overlap,
            farthest_outside=self._outside,
            seconds=seconds,
        )

    def _progress(self) -> Progress:
        done, stop = self._simulation.so_far, self._stop
        now = self._simulation.last_event_time
        shares = (now / stop.time, done.events / stop.events, done.disc_collisions / stop.disc_collisions)
        return Progress(max(shares), now, done.events)
