"""Running a scene: placing its discs, simulating them with its method, and writing all events to a log."""

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
    """Make the method of a scene; start: discs at time 0; v_ref: reference speed of a resumed run, if it was raised."""
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
    """Number of threads that a scene requests; None for as many as are worthwhile."""
    return None if run.threads == "auto" else run.threads


def threads_of(scene: Scene, gas: Gas) -> Threads:
    """Return how threads will share the work of a run; gas: discs at time 0."""
    if scene.run.method != "event_driven":
        return Threads()
    piston, shear, interacting = bool(scene.piston), bool(scene.properties.shear), scene.properties.interacting
    return expected_threads(gas, _threads(scene.run), piston, shear, interacting)


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
    """Run a scene to the end specified in its [run] table, and write its log.

    The first run with a set of effects compiles machine code, which takes several seconds and is cached on disk.

    Args:
        scene: scene from `load_scene` or `parse_scene`.
        path: path of the log, an HDF5 file that `open_log` reads.
        force: whether to overwrite an existing log.
        command: command of the run, which is stored in the log.
        on_progress: function that is called several times per second with the `Progress` of the run.
        interrupted: function that is called equally often. Once it returns True, the run stops after its latest event,
            and `completed` is False in the summary. The log can then be read and resumed, as after Ctrl-C
            (KeyboardInterrupt).
        on_events: function that is called with the next rows of the log, in order; the run waits until it returns, and
            the rows are valid only until then.

    Returns:
        The summary of the run.

    Raises:
        SceneError: the discs cannot be placed.
        OutputError: the log exists (without `force`), cannot be written, or is removed during the run.
        UserError: an inelastic collapse occurs, or the events that would end the run do not occur (see
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
    """Begin a run that a Python program advances and steers; `simulate` describes the arguments and errors.

    At the end of the context the log is closed. It is complete if the run has reached the end of its scene; otherwise
    it can be read and resumed, as after an interruption.
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
    """Compile the machine code for a scene; return the time in seconds, which is short if the code was cached.

    The scene is run up to its first event, and the log is deleted. Raises the same errors as `simulate`.
    """
    first = {"events": 1, "collisions_per_disc": None, "trials": None}
    short = scene.model_copy(update={"run": scene.run.model_copy(update=first)})
    with tempfile.TemporaryDirectory(prefix="idealgas-warm-up-") as folder:
        return simulate(short, Path(folder) / "run.h5").compile_seconds
