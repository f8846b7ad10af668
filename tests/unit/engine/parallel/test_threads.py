"""Several threads write the log of one thread, bit for bit, whatever happens at the interfaces of their slabs."""

from collections import Counter
from itertools import cycle

import numpy as np
import pytest
from helpers.log_compare import differences
from helpers.support import batch_for
from helpers.thread_samples import (
    EAGER,
    EFFECTS,
    SMALLEST_CELLS,
    compare,
    lattice,
    log_with,
    tall_scene,
    tie_at_an_interface,
    tie_with_a_late_migrant,
    wind,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.parallel.autotuner import ThreadAutotuner
from idealgas.engine.parallel.decomposition import DomainDecomposition, _Slab
from idealgas.engine.parallel.workers import Workers
from idealgas.engine.records import UNLIMITED
from idealgas.engine.simulation import Simulation, Stop
from idealgas.run.resume import resume
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

pytestmark = pytest.mark.slow

GAS = """
box.size = [60.0, 60.0]
log = { pressure = true, snapshot_every = 20.0 }
run.collisions_per_disc = 200
species = [
    { name = "a", count = 600, radius = 0.5, temperature = 1.0 },
    { name = "b", count = 900, radius = 0.25, temperature = 1.0 },
]
"""

PLAIN_SEEDS, LATTICE_SEEDS = range(8), range(10)


def assert_equal(result, expected, what=""):
    assert all(np.array_equal(a, b) for a, b in zip(result, expected, strict=True)), what


def test_gases_have_the_log_of_one_thread():
    counts = sum((compare(lambda s=seed: tall_scene("plain", s), seed) for seed in PLAIN_SEEDS), Counter())
    assert counts["7 slabs"] == len(PLAIN_SEEDS)
    assert counts["migrations"] > 1000


def test_as_many_threads_as_are_worth_it_have_the_log_of_one(monkeypatch):
    """Slices by one thread and by several follow each other, as now the one way is faster and now the other."""
    monkeypatch.setattr("idealgas.engine.parallel.slabs.cores", lambda: 3)
    ways = cycle((True, False))
    monkeypatch.setattr(ThreadAutotuner, "use_threads", lambda autotuner: next(ways))
    stop, method = Stop(events=5000), EventDriven(1e-9, None, EAGER._replace(autotune=True))
    result = log_with(*tall_scene("plain", 3), stop, 300, method)
    expected = log_with(*tall_scene("plain", 3), stop, 300, EventDriven())
    assert_equal(result, expected)
    assert method.threads[:2] == (3, "as many as there are cores")
    assert method.threads.slices - method.threads.aborted > 2


def test_times_without_an_event_and_of_several_events():
    """A slice may be shorter than the time to the next event."""
    compare(lambda: tall_scene("plain", 1005), 1005)
    compare(lambda: lattice(1822), 1822)


def test_a_run_may_go_on_without_a_log():
    gas, effects = tall_scene("plain", 3)
    simulation = Simulation(gas, EventDriven(1e-9, 3, EAGER), effects)
    for _ in simulation.slices(Stop(events=1000), batch_for(simulation, 65_536), 500):
        pass
    shared = simulation.method.threads.slices
    for _ in simulation.slices(Stop(events=3000), None, 500):
        assert not simulation.method.pending
    assert simulation.finished(Stop(events=3000))
    assert simulation.method.threads.slices > shared > 0


def test_lattices_have_the_log_of_one_thread():
    counts = sum((compare(lambda s=seed: lattice(s), seed) for seed in LATTICE_SEEDS), Counter())
    assert counts["tie"] > 0
    assert counts["slices"] > 2 * counts["tie"]


@pytest.mark.parametrize("until", [3.9, 4.1, 4.4])
def test_a_disc_of_another_strip_is_not_in_the_schedule_after_events_of_one_time(until):
    stop = Stop(time=until)
    expected = log_with(*tie_at_an_interface(), stop, UNLIMITED, EventDriven())
    method = EventDriven(1e-3, 2, EAGER)
    method.workers.rate = 1000.0, 500.0  # all is one slice
    result = log_with(*tie_at_an_interface(), stop, UNLIMITED, method)
    assert_equal(result, expected)
    assert (method.threads.slices, method.threads.aborted) == (1, 0)


def test_a_disc_that_comes_late_has_its_turn_among_events_of_one_time():
    """Which slab is ahead is random: in most of 20 runs the rows would be adjacent in the wrong order."""
    stop, ties = Stop(time=6.0), 0
    expected = log_with(*tie_with_a_late_migrant(), stop, UNLIMITED, EventDriven(SMALLEST_CELLS))
    for _ in range(20):
        method = EventDriven(SMALLEST_CELLS, 2, EAGER)
        method.workers.rate = 1000.0, 500.0  # all is one slice
        result = log_with(*tie_with_a_late_migrant(), stop, UNLIMITED, method)
        assert_equal(result, expected)
        ties += method.workers.counts["tie"]
    assert ties > 0


def test_slabs_begin_an_epoch_in_parallel(monkeypatch):
    gas, effects = tall_scene("plain", 2)
    simulation = Simulation(gas, EventDriven(1e-9, 3, EAGER), effects)
    while simulation.epoch < 1:
        simulation.advance(Stop(), None, 500)
        if simulation.epoch_over:
            simulation.next_epoch()
    monkeypatch.setattr(DomainDecomposition, "_run_serial", None)
    simulation.advance(Stop(), None, 500)
    assert simulation.counters.events > simulation.totals.events


def test_what_a_thread_fails_at_is_done_again_by_one(monkeypatch):
    """The other threads wait at their interfaces for a missing one, and notice that the slice is aborted."""
    stop, sample = Stop(events=3000), lambda: tall_scene("plain", 3)
    expected = log_with(*sample(), stop, 1000, EventDriven())
    run, calls = _Slab.run, []

    def fail(self, discs, limits, batch, subdomain, unpredicted):
        calls.append(subdomain.rank)
        if subdomain.rank == 1 and len(calls) % 2:
            raise MemoryError
        run(self, discs, limits, batch, subdomain, unpredicted)

    monkeypatch.setattr(_Slab, "run", fail)
    method = EventDriven(1e-9, 3, EAGER)
    result = log_with(*sample(), stop, 1000, method)
    assert_equal(result, expected)
    assert 0 < method.workers.counts["error"] <= method.threads.aborted


def test_an_interrupt_sets_all_back_and_ends_the_threads(monkeypatch):
    gas, effects = tall_scene("plain", 3)
    simulation = Simulation(gas, EventDriven(1e-9, 3, EAGER), effects)
    batch = batch_for(simulation, 65_536)
    simulation.advance(Stop(), batch, 500)
    before = simulation.state()[0]
    run = Workers.run

    def interrupted(self, work, number, abort_slice):
        def stopped(k):
            if k == 0:
                raise KeyboardInterrupt
            work(k)

        run(self, stopped, number, abort_slice)

    monkeypatch.setattr(Workers, "run", interrupted)
    with pytest.raises(KeyboardInterrupt):
        simulation.advance(Stop(), batch, 500)
    assert np.array_equal(simulation.state()[0].position, before.position)


def test_whole_logs_are_the_same_and_go_on_with_any_number_of_threads(tmp_path):
    result, two, cut_off = (tmp_path / f"{name}.h5" for name in ("one", "two", "cut"))
    simulate(parse_scene(GAS), result)
    summary = simulate(parse_scene(GAS, overrides=["run.threads=2"]), two)
    assert (summary.threads, summary.threads_reason) == (2, "as run.threads says")
    assert 0 <= summary.aborted_slices < summary.shared_slices
    assert differences(result, two) == []
    calls = []
    simulate(
        parse_scene(GAS, overrides=["run.threads=3"]), cut_off, interrupted=lambda: calls.append(1) or len(calls) > 9
    )
    assert resume(cut_off, ["run.threads=2"]).shared_slices > 0
    assert differences(result, cut_off) == []


@pytest.mark.parametrize(
    "effects", ["steps", "vibration", "fixed", "permeable", "absorbing", "steering", "arcs", "flow"]
)
def test_moving_and_fixed_obstacles_have_the_log_of_one_thread(effects):
    counts = sum((compare(lambda s=seed: tall_scene(effects, s), seed, (2, 4)) for seed in range(2)), Counter())
    assert counts["slices"] > 0


def test_everything_at_once_has_the_log_of_one_thread():
    counts = sum((compare(lambda s=seed: tall_scene("everything", s), seed, (3, 7)) for seed in range(1)), Counter())
    assert counts["migrations"] > 100


@pytest.mark.long
@pytest.mark.parametrize("effects", EFFECTS)
def test_many_gases_have_the_log_of_one_thread(effects):
    total = Counter()

    @settings(max_examples=40, deadline=None)
    @given(st.integers(0, 2**31))
    def run(seed):
        nonlocal total
        total += compare(lambda: tall_scene(effects, seed), seed)

    for _ in range(5):  # once in a while no thread is late enough in forty gases to change another's past
        if not total["causality"]:
            run()
    print(effects, dict(total))
    assert total["causality"] > 0


@pytest.mark.long
def test_many_lattices_have_the_log_of_one_thread():
    total = Counter()
    for seed in range(200):
        total += compare(lambda s=seed: lattice(s), seed)
    print(dict(total))
    assert total["tie"] >= 100


@pytest.mark.long
def test_discs_that_go_from_strip_to_strip_all_the_time_have_the_log_of_one_thread():
    """Pasts that have changed, clocks that are set back, and discs taken in while one's own is handed over."""
    stop, total = Stop(time=400.0), Counter()
    for seed in range(6):
        expected = log_with(*wind(seed), stop, 100, EventDriven(SMALLEST_CELLS))
        for number in (3, 7):
            method = EventDriven(SMALLEST_CELLS, number, EAGER._replace(lead=1e9))
            result = log_with(*wind(seed), stop, 100, method)
            assert_equal(result, expected, (seed, number))
            assert method.threads.number == number
            total += method.workers.counts
    print(dict(total))
    assert min(total[name] for name in ("causality", "clock_resets", "crossed_messages")) >= 100
