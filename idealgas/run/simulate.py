"""Running a scene: places the discs, simulates them with its method, and writes every event to a log."""

import math
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from idealgas.columns import EventBatch
from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven, expected_threads
from idealgas.engine.method import Method, Threads
from idealgas.engine.monte_carlo import MonteCarlo
from idealgas.engine.multiprecision import PreciseBruteForce
from idealgas.engine.simulation import TRAJECTORY, Simulation
from idealgas.engine.time_driven import TimeDriven
from idealgas.initial.build import make_gas
from idealgas.jit import compile_seconds
from idealgas.log import LogWriter
from idealgas.log.summary import Summary
from idealgas.run.effects import make_effects
from idealgas.run.energy import energy_of
from idealgas.run.layout import layout_of
from idealgas.run.logged_run import Progress, RunHistory
from idealgas.run.steered_run import SteeredRun
from idealgas.scene import Run, Scene
from idealgas.scene.defaults import reference_speed
from idealgas.state import Gas
from idealgas.toml.dump import dump_document


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
    return expected_threads(gas, _threads(scene.run), bool(scene.piston), bool(scene.properties.shear))


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
        on_events: called with the next rows of the log, in order, which it may read until it returns; the run waits.

    Raises:
        SceneError: if the discs cannot be placed.
        OutputError: if the log exists (without `force`), cannot be written, or is removed during the run.
        UserError: in an inelastic collapse, or if the events that would end the run do not occur (see
            `idealgas.run.stall`); the log can be read and resumed.
    """
    with open_run(scene, path, force=force, command=command, on_events=on_events) as run:
        return run.finish(on_progress, interrupted)


@contextmanager
def open_run(
    scene: Scene,
    path: str | os.PathLike[str],
    *,
    force: bool = False,
    command: str = "",
    on_events: Callable[[EventBatch], None] | None = None,
) -> Iterator[SteeredRun]:
    """Begin a run of a scene that the program advances and steers; `simulate` describes the arguments and errors.

    At the end of the context the log is closed: complete if the run has reached the end of its scene, or else as after
    an interruption.
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
        run = SteeredRun(scene, Simulation(gas, method, effects), log, past, compiled_before, on_events)
        yield run
        if run.ended and run.summary is None:
            run.finish()


def warm_up(scene: Scene) -> float:
    """Compile the machine code of a scene and return the seconds it took; almost none if it was cached.

    The scene runs up to its first event, and its log is deleted. Raises the same errors as `simulate`.
    """
    first = {"events": 1, "collisions_per_disc": None, "trials": None}
    short = scene.model_copy(update={"run": scene.run.model_copy(update=first)})
    with tempfile.TemporaryDirectory(prefix="idealgas-warm-up-") as folder:
        return simulate(short, Path(folder) / "run.h5").compile_seconds
