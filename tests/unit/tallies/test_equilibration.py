"""Detection of equilibrium on series that are steady, settle, drift or jump."""

import numpy as np
import pytest

from idealgas.tallies.equilibration import MARGIN, Window, _Series, detect_equilibration, unsteady
from idealgas.tallies.observables import Observable


def noise(rng, length, memory=0.0):
    result = rng.normal(size=length)
    for k in range(1, length):
        result[k] += memory * result[k - 1]
    return result


def detect(series):
    return detect_equilibration(map(Observable, series))


@pytest.mark.parametrize(("level", "normal"), [(0.1, 1.959963984540054), (0.2, 1.6448536269514722)])
def test_half_of_the_false_alarms_are_in_the_first_block(level, normal):
    """Two-sided: its deviation from the rest, of variance 2, is normal, and beyond the bound at half of the level."""
    for factor, agrees in ((1 - 1e-9, True), (1 + 1e-9, False)):
        values = np.zeros(16)  # the later half of the rest has the mean 0
        values[[0, 6]] = factor * normal * np.sqrt(2.0), -0.5
        series = _Series(np.append(0.0, np.cumsum(values)), np.ones(1), np.inf, 1.0, np.inf)
        assert series.agrees(0, level) == agrees
        assert series.agrees(0, level, floor=3.0)
        bounded = series._replace(sums=series.sums * np.sqrt(0.9), most=0.9)  # both variances are then 0.9
        assert bounded.agrees(0, level) == agrees


@pytest.mark.parametrize(("length", "memory"), [(40, 0.0), (40, 0.5), (400, 0.0), (400, 0.9), (400, -0.5), (2000, 0.9)])
def test_steady_series_are_kept(length, memory):
    """Twelve series as of a gas: the median loses no block, and at most one gas in ten more than a tenth."""
    rng = np.random.default_rng(1)
    starts = [detect([noise(rng, length, memory) for _ in range(12)]) for _ in range(60)]
    assert None not in starts
    assert np.median(starts) == 0
    assert np.mean(np.array(starts) > 0.1 * length) < 0.1


@pytest.mark.parametrize("decay", [3, 10, 40])
def test_end_of_a_transient_is_found(decay):
    rng = np.random.default_rng(2)
    starts = [detect([noise(rng, 800, 0.5) + 20 * np.exp(-np.arange(800) / decay), noise(rng, 800)]) for _ in range(20)]
    assert min(starts) >= decay
    assert np.median(starts) <= 8 * decay


def test_jump_is_found():
    """With the margin after it: as long again."""
    rng = np.random.default_rng(3)
    starts = [detect([noise(rng, 600) + 2 * (np.arange(600) < 90)]) for _ in range(20)]
    assert min(starts) >= 90
    assert np.median(starts) <= MARGIN * 110  # starts that are tried are 1.2 times the one before


def test_short_transient_is_found():
    """Three blocks of ten standard deviations, as equal speeds are for three collisions, in short and long runs."""
    rng = np.random.default_rng(8)
    for length in (40, 400):
        starts = [detect([noise(rng, length) + 10 * (np.arange(length) < 3)]) for _ in range(40)]
        assert min(starts) >= 3
        assert np.median(starts) <= 8


def test_transient_of_more_than_half_is_not_steady():
    rng = np.random.default_rng(4)
    values = noise(rng, 800, 0.5) + 0.05 * np.maximum(560 - np.arange(800), 0)
    assert detect([values]) is None


def test_a_bounded_series_tells_only_of_what_its_bound_does_not_explain():
    """A walk within its scatter by chance is none; one that starts far outside shows a transient, however smooth."""
    rng = np.random.default_rng(9)
    fluctuation = 5 * np.cos(np.arange(400) * np.pi / 400) + 0.1 * noise(rng, 400)
    still = noise(rng, 400)
    assert detect_equilibration([Observable(still), Observable(fluctuation, least=25.0)]) == 0
    assert detect_equilibration([Observable(still), Observable(10 * fluctuation, least=25.0)]) is None
    jump = noise(rng, 400) + 50 * (np.arange(400) < 5)
    assert 5 <= detect_equilibration([Observable(still), Observable(jump, least=25.0)]) <= 12


def test_known_fluctuations_show_what_a_short_series_cannot():
    """Two blocks of six standard deviations in 40 correlated ones; of 100 steady gases 10 ± 3 lose some."""
    rng = np.random.default_rng(10)
    variance = 1 / (1 - 0.6**2)
    actual = []
    for _ in range(100):
        steady = [noise(rng, 100, 0.6)[60:] for _ in range(6)]
        jump = [steady[0] + 6 * np.sqrt(variance) * (np.arange(40) < 2), *steady[1:]]
        known = ([Observable(values, most=variance) for values in series] for series in (steady, jump))
        actual.append([detect(steady), detect(jump), *map(detect_equilibration, known)])
    kept, missed, kept_by_theory, missed_by_theory = (np.array(actual) == 0).sum(axis=0)
    assert missed > 0 == missed_by_theory
    assert kept_by_theory >= kept - 4 * 3


@pytest.mark.parametrize("slope", [0.01, 1.0])
def test_drift_to_the_end_is_not_steady(slope):
    rng = np.random.default_rng(5)
    assert detect([noise(rng, 800, 0.5) + slope * np.arange(800), noise(rng, 800)]) is None
    assert detect([slope * np.arange(800.0)]) is None


def test_constant_and_short_series_are_steady():
    assert detect([np.full(100, 3.0), 1.0 + 1e-13 * np.arange(100)]) == 0
    assert detect([np.arange(10.0)]) == 0
    assert detect([]) == 0


def test_a_mean_of_what_is_not_steady_is_said():
    rng = np.random.default_rng(4)
    time = np.arange(200.0)
    assert unsteady("x", noise(rng, 200, 0.5), time) == ()
    assert unsteady("x", np.full(200, 1.5), time) == ()
    (jump,) = unsteady("x", noise(rng, 200) + 9 * (time < 60), time)
    assert jump.startswith("x is not steady in the window: the means of its parts agree only after t = ")
    (drift,) = unsteady("x", noise(rng, 200) + time / 5, time)
    assert drift.startswith("x changes too slowly for this window")
    (walk,) = unsteady("x", noise(rng, 60, 1.0), time)
    assert walk == drift


def test_a_window_is_described_in_one_line():
    edges = np.array([0.0, 1.0, 2.5])
    assert str(Window(edges, 1, True)) == "window: t = 1 to 2.5 (from detected equilibrium)"
    assert str(Window(edges, 0, False)) == "window: t = 0 to 2.5 (as asked)"
