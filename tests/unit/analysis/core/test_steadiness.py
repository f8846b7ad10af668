"""The test of steadiness on series that are steady, settle, drift or jump."""

import numpy as np
import pytest

from idealgas.analysis.core.steadiness import steady_from, unsteady


def noise(rng, length, memory=0.0):
    found = rng.normal(size=length)
    for k in range(1, length):
        found[k] += memory * found[k - 1]
    return found


@pytest.mark.parametrize(("length", "memory"), [(40, 0.0), (40, 0.5), (400, 0.0), (400, 0.9), (400, -0.5), (2000, 0.9)])
def test_steady_series_are_kept(length, memory):
    """Twelve series as of a gas: the median loses no block, and at most one gas in ten more than a tenth."""
    rng = np.random.default_rng(1)
    starts = [steady_from([noise(rng, length, memory) for _ in range(12)]) for _ in range(60)]
    assert None not in starts
    assert np.median(starts) == 0
    assert np.mean(np.array(starts) > 0.1 * length) < 0.1


@pytest.mark.parametrize("decay", [3, 10, 40])
def test_end_of_a_transient_is_found(decay):
    rng = np.random.default_rng(2)
    starts = [
        steady_from([noise(rng, 800, 0.5) + 20 * np.exp(-np.arange(800) / decay), noise(rng, 800)]) for _ in range(20)
    ]
    assert min(starts) >= decay
    assert np.median(starts) <= 8 * decay


def test_jump_is_found():
    rng = np.random.default_rng(3)
    starts = [steady_from([noise(rng, 600) + 2 * (np.arange(600) < 90)]) for _ in range(20)]
    assert min(starts) >= 80
    assert np.median(starts) <= 100


def test_late_settling_leaves_the_last_quarter():
    rng = np.random.default_rng(4)
    values = noise(rng, 800, 0.5) + 0.05 * np.maximum(560 - np.arange(800), 0)
    assert 480 <= steady_from([values]) <= 560


@pytest.mark.parametrize("slope", [0.01, 1.0])
def test_drift_to_the_end_is_not_steady(slope):
    rng = np.random.default_rng(5)
    assert steady_from([noise(rng, 800, 0.5) + slope * np.arange(800), noise(rng, 800)]) is None
    assert steady_from([slope * np.arange(800.0)]) is None


def test_constant_and_short_series_are_steady():
    assert steady_from([np.full(100, 3.0), 1.0 + 1e-13 * np.arange(100)]) == 0
    assert steady_from([np.arange(10.0)]) == 0
    assert steady_from([]) == 0


def test_a_mean_of_what_is_not_steady_is_said():
    rng = np.random.default_rng(4)
    time = np.arange(200.0)
    assert unsteady("x", noise(rng, 200, 0.5), time) == ()
    assert unsteady("x", np.full(200, 1.5), time) == ()
    (jump,) = unsteady("x", noise(rng, 200) + 9 * (time < 60), time)
    assert jump.startswith("x is not steady in the window: only from t = ")
    (drift,) = unsteady("x", noise(rng, 200) + time / 5, time)
    assert drift.startswith("x changes as slowly as the window is long")
    (walk,) = unsteady("x", noise(rng, 60, 1.0), time)
    assert walk == drift
