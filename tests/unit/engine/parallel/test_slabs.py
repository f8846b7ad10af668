"""Decomposition of a gas into slabs, and its number of threads."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from idealgas.engine.parallel.slabs import DEFAULT_TUNING, choose_threads, slab_edges
from idealgas.engine.parallel.subdomain import MIN_ROWS


@given(st.lists(st.integers(0, 50), min_size=2 * MIN_ROWS, max_size=200), st.integers(2, 9))
def test_slabs_are_high_enough_and_share_equally_where_they_can(discs, most):
    slabs = min(most, len(discs) // MIN_ROWS)
    edges = slab_edges(np.array([0, *discs, 0]), slabs)
    assert edges[0] == 1
    assert edges[-1] == len(discs) + 1
    assert min(np.diff(edges)) >= MIN_ROWS
    even = slab_edges(np.array([0, *[7] * len(discs), 0]), slabs)
    assert np.ptp(np.diff(even)) <= 2


def test_a_number_of_threads_and_why(monkeypatch):
    monkeypatch.setattr("numba.config.DISABLE_JIT", 0)
    monkeypatch.setattr("idealgas.engine.parallel.slabs.cores", lambda: 4)
    assert choose_threads(3, 100, 50, "")[:2] == (3, "as run.threads says")
    assert choose_threads(3, 2 * MIN_ROWS + 1, 50, "")[0] == 2
    assert choose_threads(1, 5, 50, "")[:2] == (1, "as run.threads says")
    assert choose_threads(None, 1000, 10**6, "")[:2] == (4, "as many as there are cores")
    assert choose_threads(None, 1000, 12_000, "")[:2] == (2, "each has at least 5000 discs")
    assert choose_threads(None, 100, 10**6, "")[:2] == (3, "each has at least 32 rows of cells")
    assert choose_threads(None, 10, 100, "")[0] == 1
    assert choose_threads(3, 100, 50, "far")[:2] == (1, "far")
    assert 0 < choose_threads(None, 1000, 10**6, "").serial_events < DEFAULT_TUNING.min_events
    assert [threads for threads in (1, 3, 4, 5) if choose_threads(threads, 1000, 10**6, "").serial_events] == [4, 5]
