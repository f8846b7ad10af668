"""Several threads write the log of one, bit for bit, whatever they meet at the borders of their strips."""

import time
from collections import Counter
from itertools import cycle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from log_compare import differences
from support import batch_for
from thread_samples import (
    EAGER,
    EFFECTS,
    SMALLEST_CELLS,
    compare,
    lattice,
    log_with,
    tall_scene,
    tie_at_a_border,
    tie_with_a_disc_that_comes_late,
    wind,
)

from idealgas.engine.event_driven.border import LEAST_ROWS
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.event_driven.race import Race
from idealgas.engine.event_driven.strips import FAST, cut, share_out
from idealgas.engine.event_driven.team import STOP, Crew, Team, _Strip
from idealgas.engine.records import UNLIMITED
from idealgas.engine.simulation import Simulation, Stop
from idealgas.physics.exact_sum import TOGETHER, add_all, add_sums, make_sums, values
from idealgas.run.resume import resume
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

# ── how the work is shared ──


@given(st.lists(st.integers(0, 50), min_size=2 * LEAST_ROWS, max_size=200), st.integers(2, 9))
def test_strips_are_high_enough_and_share_equally_where_they_can(discs, most):
    strips = min(most, len(discs) // LEAST_ROWS)
    edges = cut(np.array([0, *discs, 0]), strips)
    assert edges[0] == 1
    assert edges[-1] == len(discs) + 1
    assert min(np.diff(edges)) >= LEAST_ROWS
    even = cut(np.array([0, *[7] * len(discs), 0]), strips)
    assert np.ptp(np.diff(even)) <= 2


def test_a_number_of_threads_and_why(monkeypatch):
    monkeypatch.setattr("numba.config.DISABLE_JIT", 0)
    monkeypatch.setattr("idealgas.engine.event_driven.strips.cores", lambda: 4)
    assert share_out(3, 100, 50, True)[:2] == (3, "as run.threads says")
    assert share_out(3, 2 * LEAST_ROWS + 1, 50, True)[0] == 2
    assert share_out(1, 5, 50, True)[:2] == (1, "as run.threads says")
    assert share_out(None, 1000, 10**6, True)[:2] == (4, "as many as there are cores")
    assert share_out(None, 1000, 12_000, True)[:2] == (2, "each has at least 5000 discs")
    assert share_out(None, 100, 10**6, True)[:2] == (3, "each has at least 32 rows of cells")
    assert share_out(None, 10, 100, True)[0] == 1
    assert share_out(3, 100, 50, False)[0] == 1


def test_where_no_core_is_left_one_thread_can_be_asked_for(monkeypatch):
    monkeypatch.setattr("numba.config.DISABLE_JIT", 0)
    monkeypatch.setattr("idealgas.engine.event_driven.strips.cores", lambda: 4)
    assert 0 < share_out(None, 1000, 10**6, True).alone < FAST.events
    assert [share_out(threads, 1000, 10**6, True).alone > 0 for threads in (1, 3, 4, 5)] == [False, False, True, True]


def test_the_faster_way_is_taken_and_the_slower_one_tried_again(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("time.perf_counter", lambda: now[0])
    race = Race()
    assert not race.shares()
    race.note(False, 100, 1.0)
    assert race.shares()
    race.note(True, 100, 3.0)
    assert not race.shares()
    now[0] = 100.0
    assert race.shares()
    race.note(True, 100, 0.5)
    assert race.shares()


def test_a_way_that_gets_slow_is_not_tried_again_at_once(monkeypatch):
    """As when other work begins on the machine."""
    now = [0.0]
    monkeypatch.setattr("time.perf_counter", lambda: now[0])
    race = Race()
    race.note(False, 100, 1.0)
    race.note(True, 100, 0.5)
    now[0] = 5.0
    assert race.shares()
    race.note(True, 100, 40.0)
    assert not race.shares()
    assert race.is_trial(True)
    now[0] = 5.0 + 20 * 40.0
    assert race.shares()


def test_the_first_shared_slice_is_a_short_one(monkeypatch):
    foretold = {True: [], False: []}

    def shared(team, goal, limits, epoch_start, batch, counters):
        foretold[team._crew.race.open].append((goal - counters[0].time) * team._crew.rate[0])
        return "tie"  # done again by one thread, and noted as what the threads took

    monkeypatch.setattr(Team, "_given_up", shared)
    monkeypatch.setattr(Race, "shares", lambda race: True)
    method = EventDriven(SMALLEST_CELLS, 2, EAGER._replace(race=True, events=20))
    gas, effects = tall_scene("plain", 1)
    log_with(gas, effects, Stop(events=5000), 300, method)
    assert len(foretold[True]) == 1
    assert foretold[True][0] <= max(40, len(gas)) < min(foretold[False])


def test_slices_beyond_the_events_foretold_do_not_keep_threads_from_sharing(monkeypatch):
    """They come where the rate rises, as in a lattice that melts, and take their time in vain."""
    tried = []
    monkeypatch.setattr(Team, "_given_up", lambda *given: tried.append(time.sleep(0.01)) or STOP)
    method = EventDriven(1e-9, 3, EAGER._replace(race=True))
    log_with(*tall_scene("plain", 3), Stop(events=5000), 300, method)
    assert len(tried) > 10


# ── sums are put together ──


@np.errstate(over="ignore")  # words wrap around, of which Python warns
def test_parts_of_sums_add_up_to_the_bit():
    draw = np.random.default_rng(5)
    terms = draw.normal(size=TOGETHER) * 10.0 ** draw.integers(-9, 12, TOGETHER)
    whole, *parts = (make_sums([1.0]) for _ in range(4))
    add_all(whole[0], terms)
    for k in range(3):
        add_all(parts[k][0], terms[k::3])
    total = make_sums([1.0])
    for part in parts:
        add_sums(total, part)
    assert total.tolist() == whole.tolist()
    assert values(total)[0] != 0


# ── logs ──

GAS = """
box.size = [60.0, 60.0]
log = { pressure = true, snapshot_every = 20.0 }
run.collisions_per_disc = 200
[[species]]
name = "a"
count = 600
radius = 0.5
temperature = 1.0
[[species]]
name = "b"
count = 900
radius = 0.25
temperature = 1.0
"""

PLAIN_SEEDS, LATTICE_SEEDS = range(8), range(10)


@pytest.mark.slow
def test_gases_have_the_log_of_one_thread():
    facts = sum((compare(lambda s=seed: tall_scene("plain", s), seed) for seed in PLAIN_SEEDS), Counter())
    assert facts["7 strips"] == len(PLAIN_SEEDS)
    assert facts["posts"] > 1000


@pytest.mark.slow
def test_as_many_threads_as_are_worth_it_have_the_log_of_one(monkeypatch):
    """Slices by one thread and by several follow each other, as now the one way is faster and now the other."""
    monkeypatch.setattr("idealgas.engine.event_driven.strips.cores", lambda: 3)
    ways = cycle((True, False))
    monkeypatch.setattr(Race, "shares", lambda race: next(ways))
    stop, method = Stop(events=5000), EventDriven(1e-9, None, EAGER._replace(race=True))
    found = log_with(*tall_scene("plain", 3), stop, 300, method)
    expected = log_with(*tall_scene("plain", 3), stop, 300, EventDriven())
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))
    assert method.threads[:2] == (3, "as many as there are cores")
    assert method.threads.slices - method.threads.given_up > 2


@pytest.mark.slow
def test_a_time_without_an_event_is_passed():
    """A slice may be shorter than the time to the next event."""
    compare(lambda: tall_scene("plain", 1005), 1005)


@pytest.mark.slow
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


@pytest.mark.slow
def test_lattices_have_the_log_of_one_thread():
    facts = sum((compare(lambda s=seed: lattice(s), seed) for seed in LATTICE_SEEDS), Counter())
    assert facts["tie"] > 0
    assert facts["slices"] > 2 * facts["tie"]


@pytest.mark.slow
def test_a_disc_that_comes_over_has_its_turn_among_events_of_one_time():
    compare(lambda: lattice(1822), 1822)


@pytest.mark.slow
@pytest.mark.parametrize("until", [3.9, 4.1, 4.4])
def test_a_disc_of_another_strip_is_not_in_the_schedule_after_events_of_one_time(until):
    stop = Stop(time=until)
    expected = log_with(*tie_at_a_border(), stop, UNLIMITED, EventDriven())
    method = EventDriven(1e-3, 2, EAGER)
    method.crew.rate = 1000.0, 500.0  # all is one slice
    found = log_with(*tie_at_a_border(), stop, UNLIMITED, method)
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))
    assert (method.threads.slices, method.threads.given_up) == (1, 0)


@pytest.mark.slow
def test_a_disc_that_comes_late_has_its_turn_among_events_of_one_time():
    """Which strip is ahead is chance: on most of 20 runs the rows were side by side in the wrong order."""
    stop, ties = Stop(time=6.0), 0
    expected = log_with(*tie_with_a_disc_that_comes_late(), stop, UNLIMITED, EventDriven(SMALLEST_CELLS))
    for _ in range(20):
        method = EventDriven(SMALLEST_CELLS, 2, EAGER)
        method.crew.rate = 1000.0, 500.0  # all is one slice
        found = log_with(*tie_with_a_disc_that_comes_late(), stop, UNLIMITED, method)
        assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))
        ties += method.crew.facts["tie"]
    assert ties > 0


@pytest.mark.slow
def test_strips_begin_an_epoch_without_a_thread_that_does_it_alone(monkeypatch):
    gas, effects = tall_scene("plain", 2)
    simulation = Simulation(gas, EventDriven(1e-9, 3, EAGER), effects)
    while simulation.epoch < 1:
        simulation.advance(Stop(), None, 500)
        if simulation.epoch_over:
            simulation.next_epoch()
    monkeypatch.setattr(Team, "_alone", None)
    simulation.advance(Stop(), None, 500)
    assert simulation.counters.events > simulation.totals.events


@pytest.mark.slow
def test_what_a_thread_fails_at_is_done_again_by_one(monkeypatch):
    """The others wait at their borders for one that is not there, and see that the work is given up."""
    stop, sample = Stop(events=3000), lambda: tall_scene("plain", 3)
    expected = log_with(*sample(), stop, 1000, EventDriven())
    run, calls = _Strip.run, []

    def fail(self, record, ids, limits, batch, border, unpredicted):
        calls.append(border.me)
        if border.me == 1 and len(calls) % 2:
            raise MemoryError
        run(self, record, ids, limits, batch, border, unpredicted)

    monkeypatch.setattr(_Strip, "run", fail)
    method = EventDriven(1e-9, 3, EAGER)
    found = log_with(*sample(), stop, 1000, method)
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))
    assert 0 < method.crew.facts["error"] <= method.threads.given_up


@pytest.mark.slow
def test_an_interrupt_sets_all_back_and_ends_the_threads(monkeypatch):
    gas, effects = tall_scene("plain", 3)
    simulation = Simulation(gas, EventDriven(1e-9, 3, EAGER), effects)
    batch = batch_for(simulation, 65_536)
    simulation.advance(Stop(), batch, 500)
    before = simulation.state()[0]
    run = Crew.run

    def interrupted(self, work, number, give_up):
        def stopped(k):
            if k == 0:
                raise KeyboardInterrupt
            work(k)

        run(self, stopped, number, give_up)

    monkeypatch.setattr(Crew, "run", interrupted)
    with pytest.raises(KeyboardInterrupt):
        simulation.advance(Stop(), batch, 500)
    assert np.array_equal(simulation.state()[0].position, before.position)


@pytest.mark.slow
def test_whole_logs_are_the_same_and_go_on_with_any_number_of_threads(tmp_path):
    one, two, cut_off = (tmp_path / f"{name}.h5" for name in ("one", "two", "cut"))
    simulate(parse_scene(GAS), one)
    summary = simulate(parse_scene(GAS, overrides=["run.threads=2"]), two)
    assert (summary.threads, summary.threads_because) == (2, "as run.threads says")
    assert 0 <= summary.given_up_slices < summary.shared_slices
    assert differences(one, two) == []
    calls = []
    simulate(
        parse_scene(GAS, overrides=["run.threads=3"]),
        cut_off,
        interrupted=lambda: calls.append(1) or len(calls) > 9,
    )
    assert resume(cut_off, ["run.threads=2"]).shared_slices > 0
    assert differences(one, cut_off) == []


@pytest.mark.slow
def test_everything_at_once_has_the_log_of_one_thread():
    facts = sum((compare(lambda s=seed: tall_scene("everything", s), seed, (3, 7)) for seed in range(1)), Counter())
    assert facts["posts"] > 100


@pytest.mark.long
@pytest.mark.parametrize("effects", EFFECTS)
def test_many_gases_have_the_log_of_one_thread(effects):
    total = Counter()

    @settings(max_examples=40, deadline=None)
    @given(st.integers(0, 2**31))
    def run(seed):
        nonlocal total
        total += compare(lambda: tall_scene(effects, seed), seed)

    run()
    print(effects, dict(total))
    assert total["past"] > 0


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
            found = log_with(*wind(seed), stop, 100, method)
            assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True)), (seed, number)
            assert method.threads.number == number
            total += method.crew.facts
    print(dict(total))
    assert min(total[name] for name in ("past", "set_back", "while_posting")) >= 100
