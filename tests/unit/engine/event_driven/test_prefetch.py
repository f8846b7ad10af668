"""Memory that is fetched ahead changes no event."""

import numpy as np
import pytest
from helpers.effect_samples import log_of, make_effects, make_gas
from helpers.thread_samples import compare, lattice, tall_scene

from idealgas.effects.bundle import Effects
from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.event_driven.prefetch import FROM, make_pipeline
from idealgas.engine.event_driven.scheduler import make_tree
from idealgas.engine.simulation import Stop

pytestmark = pytest.mark.usefixtures("always")


@pytest.fixture
def always(monkeypatch):
    """Look ahead in gases of any size."""
    monkeypatch.setattr("idealgas.engine.event_driven.prefetch.FROM", 1)


def test_only_large_gases_look_ahead(monkeypatch):
    monkeypatch.setattr("idealgas.engine.event_driven.prefetch.FROM", FROM)
    assert make_pipeline(FROM - 1, 6) is None
    assert make_pipeline(FROM, 6) is not None


@pytest.mark.parametrize(
    ("n", "level"), [(4, 0), (12, 0), (7000, 3), (10_000, 4), (32_768, 4), (32_769, 4), (10**6, 5)]
)
def test_parts_are_eight_or_more_unless_memory_is_near(n, level):
    assert make_pipeline(n, len(make_tree(n).start))[2] == level
    parts = -(-n // 8**level)
    assert parts <= 64
    assert parts >= 8 or n <= 32_768


@pytest.mark.parametrize("names", [set(), pytest.param({"periodic", "piston"}, marks=pytest.mark.slow)])
@pytest.mark.parametrize("events", [pytest.param(60, marks=pytest.mark.interpreted), 5000])
def test_the_log_is_that_of_the_oracle(names, events):
    """In cells of two sizes."""
    gas = make_gas(5)
    *result, oracle = (
        log_of(gas, make_effects(names, gas) if names else Effects(), method, Stop(events=events), 1000)
        for method in (EventDriven(), EventDriven(1e-9), BruteForce())
    )
    assert all(np.array_equal(a, b) for log in result for a, b in zip(log, oracle, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize(("sample", "seed"), [(lambda: tall_scene("periodic", 8), 8), (lambda: lattice(6), 6)])
def test_several_threads(sample, seed):
    assert compare(sample, seed, (2, 3))["slices"] > 0
