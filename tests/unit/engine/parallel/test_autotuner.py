"""The choice between several threads and one: the faster mode is used, and the other one tried again now and then."""

import time

from helpers.thread_samples import EAGER, SMALLEST_CELLS, log_with, tall_scene

from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.parallel.autotuner import ThreadAutotuner
from idealgas.engine.parallel.decomposition import DomainDecomposition
from idealgas.engine.parallel.workers import STOP
from idealgas.engine.simulation import Stop


def test_the_faster_way_is_taken_and_the_slower_one_tried_again_later(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("time.perf_counter", lambda: now[0])
    autotuner = ThreadAutotuner()
    assert not autotuner.use_threads()
    autotuner.note(False, 100, 1.0)
    assert autotuner.use_threads()
    autotuner.note(True, 100, 3.0)
    assert not autotuner.use_threads()
    now[0] = 100.0
    assert autotuner.use_threads()
    autotuner.note(True, 100, 0.5)
    assert autotuner.use_threads()
    # As when other work begins on the machine.
    now[0] = 0.0
    autotuner = ThreadAutotuner()
    autotuner.note(False, 100, 1.0)
    autotuner.note(True, 100, 0.5)
    now[0] = 5.0
    assert autotuner.use_threads()
    autotuner.note(True, 100, 40.0)
    assert not autotuner.use_threads()
    assert autotuner.is_trial(True)
    now[0] = 5.0 + 20 * 40.0
    assert autotuner.use_threads()


def test_the_first_shared_slice_is_a_short_one(monkeypatch):
    planned = {True: [], False: []}

    def shared(decomposition, end, limits, epoch_start, batch, counters):
        planned[decomposition._workers.autotuner.undecided].append(
            (end - counters[0].time) * decomposition._workers.rate[0]
        )
        return "tie"  # done again by one thread, and noted as what the threads took

    monkeypatch.setattr(DomainDecomposition, "_run_slice", shared)
    monkeypatch.setattr(ThreadAutotuner, "use_threads", lambda autotuner: True)
    monkeypatch.setattr("time.perf_counter", lambda: 0.0)  # both ways are as fast: only the first slice is a trial
    method = EventDriven(SMALLEST_CELLS, 2, EAGER._replace(autotune=True, min_events=20))
    gas, effects = tall_scene("plain", 1)
    log_with(gas, effects, Stop(events=5000), 300, method)
    assert len(planned[True]) == 1
    assert planned[True][0] <= max(40, len(gas)) < min(planned[False])


def test_slices_beyond_the_planned_events_do_not_keep_threads_from_sharing(monkeypatch):
    """They come where the rate rises, as in a lattice that melts, and take their time in vain."""
    tried = []
    monkeypatch.setattr(DomainDecomposition, "_run_slice", lambda *given: tried.append(time.sleep(0.01)) or STOP)
    method = EventDriven(1e-9, 3, EAGER._replace(autotune=True))
    log_with(*tall_scene("plain", 3), Stop(events=5000), 300, method)
    assert len(tried) > 10
