"""Scenes of every kind by several threads, in slabs as low as can be: the log of one thread, dataset by dataset."""

import numpy as np
import pytest
from helpers.log_compare import differences, scene_of
from helpers.support import ROOT
from helpers.thread_samples import EAGER, SMALLEST_CELLS, late_threads

from idealgas.bench.bench import bench_scene
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.parallel.subdomain import MIN_ROWS
from idealgas.run.simulate import simulate
from idealgas.scene import load_scene

pytestmark = pytest.mark.long

EVENTS = 6000
THREADS = (2, 3, 4, 7)


def is_shared(scene) -> bool:
    """Whether several threads may run a scene at all."""
    largest = max((kind.largest_radius for kind in scene.species), default=scene.box.size[1])
    rows = scene.box.size[1] / (2.001 * largest)
    return scene.run.method == "event_driven" and not scene.piston and rows >= 2 * MIN_ROWS


SHIPPED = [path.stem for path in sorted((ROOT / "configs").glob("*.toml")) if is_shared(load_scene(path))]


@pytest.fixture
def thin_slabs(monkeypatch):
    """Slabs as thin as possible, whose threads begin late at random."""

    def eager(threads: int) -> EventDriven:
        return EventDriven(SMALLEST_CELLS, threads, EAGER)

    monkeypatch.setattr("idealgas.engine.methods.EventDriven", eager)
    with late_threads(np.random.default_rng(1)):
        yield


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_scene_has_the_log_of_one_thread(name, thin_slabs, tmp_path):
    actual = tmp_path / "one.h5"
    simulate(scene_of(name, f"run.events={EVENTS}", "run.threads=1"), actual)
    for number in THREADS:
        several = tmp_path / f"{number}.h5"
        done = simulate(scene_of(name, f"run.events={EVENTS}", f"run.threads={number}"), several)
        print(name, number, done.threads, done.shared_slices, done.aborted_slices)
        assert 2 <= done.threads <= number
        assert done.shared_slices > done.aborted_slices
        assert differences(actual, several) == []


def test_many_discs_have_the_log_of_one_thread(tmp_path):
    """10⁵ discs, cells and slices as they are for everybody."""
    actual = tmp_path / "one.h5"
    simulate(bench_scene(100_000, 0.1, 400_000, True, 1), actual)
    for number in THREADS:
        several = tmp_path / f"{number}.h5"
        done = simulate(bench_scene(100_000, 0.1, 400_000, True, number), several)
        print(number, done.threads, done.shared_slices, done.aborted_slices)
        assert done.threads == number
        assert differences(actual, several) == []
