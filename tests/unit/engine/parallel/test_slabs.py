"""The cut of a gas into strips, and how many threads it gets."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from idealgas.engine.parallel.slabs import FAST, cut, share_out
from idealgas.engine.parallel.subdomain import LEAST_ROWS


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
    monkeypatch.setattr("idealgas.engine.parallel.slabs.cores", lambda: 4)
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
    monkeypatch.setattr("idealgas.engine.parallel.slabs.cores", lambda: 4)
    assert 0 < share_out(None, 1000, 10**6, True).alone < FAST.events
    assert [share_out(threads, 1000, 10**6, True).alone > 0 for threads in (1, 3, 4, 5)] == [False, False, True, True]
