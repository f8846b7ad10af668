"""Scenes with any effects at nasty scales: every event is checked, and brute force writes the same log.

All effects go into one compilation, those that a scene does not call for with numbers that change nothing; only gravity
is there or not. A scene that once broke something is kept in tests/cases/once_broke.
"""

import math
import os
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from helpers.fuzz_scenes import scene_and_gas, scene_texts
from helpers.invariants import InvariantChecker
from helpers.paths import MaxErrors
from helpers.support import ROOT, batches, joined, record, same_rows
from hypothesis import HealthCheck, example, given, settings

from idealgas.columns import FIRST_SEGMENT, EventBatch
from idealgas.effects.bundle import Effects, inner_energy
from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop
from idealgas.jit import aligned
from idealgas.physics.arc import ARC
from idealgas.physics.exact_sum import make_sums
from idealgas.physics.motion import MAX_DISPLACEMENT
from idealgas.physics.periodic import Periodic
from idealgas.physics.permeable import Permeable
from idealgas.physics.piston import PISTON
from idealgas.physics.restitution import Restitution
from idealgas.physics.rotation import Rotation
from idealgas.physics.thermal import Thermal
from idealgas.physics.thermostat import Thermostat
from idealgas.physics.vibration import VIBRATION
from idealgas.physics.wall import SEGMENT
from idealgas.run.effects import make_effects, with_sums
from idealgas.run.logged_run import stop_of
from idealgas.scene import Scene
from idealgas.state import Gas

TIMEOUT = 300.0  # seconds of the processor for a scene: some milliseconds and, at first, compilation
MOST_EPOCHS = 5_000  # no scene has many, but for those in which a disc goes a long way and meets nothing


@contextmanager
def watchdog(text: str) -> Iterator[None]:
    """Ends the process if a scene hangs, and leaves the scene behind. The engine lets other threads run."""

    done, started = threading.Event(), time.process_time()

    def watch() -> None:
        while not done.wait(1.0):
            if time.process_time() - started > TIMEOUT:
                (Path(tempfile.gettempdir()) / "idealgas-hangs.toml").write_text(text)
                os.abort()

    threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    finally:
        done.set()


def fresh_effects(scene: Scene, gas: Gas) -> Effects:
    """All effects but gravity, those not called for without any effect."""
    n, walls = len(gas), len(scene.walls)
    called = make_effects(scene, gas)
    beyond = aligned(1, PISTON)
    beyond[0].x = beyond[0].length = math.inf
    beyond[0].wall, beyond[0].outward = -1, 1.0
    neutral = Effects(
        periodic=Periodic(False, False, *gas.box, np.zeros((n, 2), np.int32)),
        segments=aligned(0, SEGMENT),
        arcs=aligned(walls, ARC),
        absorbing=np.zeros(walls, bool),
        permeable=Permeable(np.zeros(n, np.uint16), np.zeros((walls, 1), np.uint8)),
        rotation=Rotation(np.zeros(n), 0.5 * gas.mass * gas.radius**2, -1.0, -1.0),
        restitution=Restitution(1.0, 1.0, 0.0, np.full(n, -math.inf)),
        thermal=Thermal(np.full(FIRST_SEGMENT + walls, -1.0), np.uint64(0), np.zeros(n, np.uint64)),
        vibration=aligned(4, VIBRATION),
        piston=beyond,
        thermostat=Thermostat(0.0, 0.0, np.uint64(0), np.full(n, math.inf), np.zeros(n, np.uint64)),
    )
    inner, effects = inner_energy(called, gas), _filled(called, neutral)
    every = with_sums(effects, scene, gas, gives_energy=True, loses_energy=True, inner_energy=inner)
    return _filled(called, every._replace(bath_energy=make_sums([1.0])))


def _filled(effects: Effects, others: Effects) -> Effects:
    """The effects, and of the others those that are missing among them."""
    return Effects(*(other if own is None else own for own, other in zip(effects, others, strict=True)))


def log_of_brute_force(scene: Scene, gas: Gas, stop: Stop) -> EventBatch:
    """The whole log by brute force."""
    return record(Simulation(gas, BruteForce(), fresh_effects(scene, gas)), stop, 1024)


def run_scene(text: str, max_errors: MaxErrors) -> None:
    """Run a scene event by event before an invariant checker, to exactly where it should end, then by brute force."""
    scene, gas = scene_and_gas(text)
    stop = stop_of(scene, len(gas))
    effects = fresh_effects(scene, gas)
    simulation = Simulation(gas, EventDriven(), effects)
    invariants = InvariantChecker(scene, gas, effects, max_errors)
    seen: list[EventBatch] = []
    begin_next = simulation.next_epoch

    def next_epoch() -> None:
        """Show the checker the state between two epochs, which the next event changes."""
        begin_next()
        if len(simulation.steered):
            invariants.steer(simulation)

    simulation.next_epoch = next_epoch
    longest, path = MAX_DISPLACEMENT * gas.radius.min(), 0.0  # an epoch's, at least, unless there is much to do
    for rows in batches(simulation, stop, 4, events=1):
        if len(rows.time):
            seen.append(rows)
            invariants.see(rows, simulation)
        if simulation.epoch_over:
            path += np.hypot(*simulation.state()[0].velocity.T).max() * min(simulation.length, stop.time)
        assert simulation.epoch < MOST_EPOCHS + path / longest, "the clock hardly runs"
    by_time = simulation.counters.events < stop.events
    assert simulation.counters.events - simulation.counters.steered == len(seen) <= stop.events
    assert simulation.last_event_time <= stop.time
    if by_time:
        invariants.finish(stop.time, simulation)
    oracle = log_of_brute_force(scene, gas, stop)
    if seen:
        assert same_rows(joined(seen), oracle), "not the log of brute force"
    else:
        assert not len(oracle.time)


scenes = given(scene_texts())
quick = settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


def with_what_once_broke(test: Callable) -> Callable:
    """A test of texts that begins with the scenes whose first line says what went wrong."""
    for path in sorted((ROOT / "tests" / "cases" / "once_broke").glob("*.toml")):
        test = example(path.read_text(encoding="utf-8"))(test)
    return test


@with_what_once_broke
@quick
@scenes
@pytest.mark.slow
def test_scenes_with_any_effects(text):
    with watchdog(text):
        run_scene(text, MaxErrors())


@pytest.mark.long
def test_many_scenes_with_any_effects():
    """Prints what the bounds were compared with at worst."""
    max_errors, count = MaxErrors(), 0

    @settings(quick, max_examples=20_000)
    @scenes
    def run(text):
        nonlocal count
        with watchdog(text):
            run_scene(text, max_errors)
        count += 1

    run()
    print(f"{count} scenes, {max_errors}")
