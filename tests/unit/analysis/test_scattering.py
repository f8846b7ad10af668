"""Density and current correlations: slow sums, exact values at short times, continuity, and which gases are refused."""

import math

import numpy as np
import pytest

import idealgas
from idealgas import open_log, parse_scene, simulate
from idealgas.analysis.scattering.sums import correlation, segments
from idealgas.errors import NotApplicableError, UserError

GAS = """
scene.seed = 5
run.collisions_per_disc = 600
[box]
size = [9, 9]
left = "periodic"
right = "periodic"
bottom = "periodic"
top = "periodic"
[[species]]
name = "gas"
count = 30
radius = 0.5
mass = 2
temperature = 1.5
"""
TEMPERATURE = 1.5 * 60 / 58
"""T = 2E/D with D = 2N - 2."""


def test_correlation_is_a_mean_over_starts():
    draw = np.random.default_rng(1)
    series = draw.normal(size=(23, 4)) + 1j * draw.normal(size=(23, 4))
    slow = [np.mean([(series[t + lag] * series[t].conj()).real.sum() for t in range(16)]) for lag in range(8)]
    assert correlation(series, 8) == pytest.approx(slow)


def test_sums_against_states(make, monkeypatch):
    """One segment by hand, from the states of the log; with two chunks of discs."""
    monkeypatch.setattr("idealgas.analysis.scattering.sums.MOST_IN_MEMORY", 800)
    log = make("run.collisions_per_disc=40")
    found = idealgas.analyse(log, "scattering", start=0.0)
    k, step, lags = 2 * math.pi / 9, 0.05, 17
    window = found.window
    *_, one = segments(log, window, k, step, lags)
    room = window.duration - (lags - 1) * step
    begin = window.start + room / 32 * 31
    starts = min(max(int(room / 32 / step), 1), 32)
    states = [log.state_at(begin + step * n) for n in range(starts + lags - 1)]
    position = np.array([state.position for state in states])
    velocity = np.array([state.velocity for state in states])
    assert 800 < 30 * len(states) <= 1600
    lag, pairs = 5, [(t + 5, t) for t in range(starts)]
    found = dict.fromkeys(("density", "along", "across", "own"), 0.0)
    for axis in range(2):
        wave = np.exp(-1j * k * position[:, :, axis])
        for name, weight in (("density", 1.0), ("along", velocity[:, :, axis]), ("across", velocity[:, :, 1 - axis])):
            total = (weight * wave).sum(axis=1)
            found[name] += np.mean([(total[later] * total[t].conj()).real for later, t in pairs]) / 60
        found["own"] += np.mean([(wave[later] * wave[t].conj()).real.mean() for later, t in pairs]) / 2
    got = one.density[lag], one.longitudinal[lag], one.transverse[lag], one.self_part[lag]
    assert got == pytest.approx(tuple(found.values()))


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("scattering") / "run.h5"
    simulate(parse_scene(GAS), path)
    with open_log(path) as log:
        yield log


@pytest.fixture(scope="module")
def found(log):
    return idealgas.scattering(log)


def test_exact_values_and_continuity(found):
    """Currents at t = 0 and F_s after a short time by theory, k = 4; -d²F/dt² = k² C_L and α₂(0) = -2/(D + 2)."""
    assert found.thermal_speed == pytest.approx(math.sqrt(TEMPERATURE / 2))
    assert [round(one.k * 9 / (2 * math.pi)) for one in found.waves] == [1, 2, 4, 9]
    for one in found.waves:
        square = TEMPERATURE / 2 * (1 - one.structure.value / 30)
        assert (one.longitudinal_square.theory, one.transverse_square.theory) == pytest.approx((square, square))
        for estimate in (one.longitudinal_square, one.transverse_square, one.early):
            assert estimate.theory is None or abs(estimate.deviation) < 4
        step, current = one.time[1], one.k**2 * one.longitudinal.value
        slope = np.append(0.0, np.cumsum(step * (current[1:] + current[:-1]) / 2))
        fall = np.append(0.0, np.cumsum(step * (slope[1:] + slope[:-1]) / 2))
        noise = 4 * np.hypot(one.density.error, one.density.error[0])
        assert (np.abs(one.density.value[0] - one.density.value - fall) < noise + 0.01)[:16].all()
        assert one.self_part.value[0] == pytest.approx(1, rel=1e-12)
    assert any(one.early.theory is not None for one in found.waves)
    assert abs(found.non_gaussian.value[0] + 2 / 60) < 4 * found.non_gaussian.error[0] + 0.01


def test_structure_is_that_of_order(log, found):
    """S(k) of the longest waves from instants of its own; k = 4."""
    structure, (wave, *_) = idealgas.order(log).structure, found.waves
    assert structure.k[0] == pytest.approx(wave.k)
    error = math.hypot(structure.error[0], wave.structure.standard_error)
    assert abs(structure.value[0] - wave.structure.value) < 4 * error


def test_spectrum_has_the_structure_as_its_integral(found):
    """∫ S(k, ω) dω/2π = S(k): sum over the frequencies of the transform, exactly but for those left out."""
    for one in found.waves:
        integral = (2 * one.spectrum.value[1:].sum() + one.spectrum.value[0]) * one.frequency[1] / (2 * math.pi)
        assert integral == pytest.approx(one.structure.value, rel=0.03)


def test_other_gases_are_refused(make):
    log = make("box.left=reflecting", "box.right=reflecting", "run.collisions_per_disc=10")
    with pytest.raises(NotApplicableError, match="one species in a periodic box"):
        idealgas.scattering(log)


def test_too_short(log):
    with pytest.raises(UserError, match="window too short"):
        idealgas.scattering(log, start=0.0, end=1.0)
