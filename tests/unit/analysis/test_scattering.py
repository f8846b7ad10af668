"""Density and current correlations: slow sums, exact values at short times, continuity, and which gases are refused."""

import math

import numpy as np
import pytest
from helpers.logs import gas, log_of

import idealgas
from idealgas.analysis.scattering.distinct import distinct_parts
from idealgas.analysis.scattering.sums import correlation, read, segments
from idealgas.tallies.equilibration import Window

GAS = gas(30, 0.5, (9, 9), "collisions_per_disc = 600", periodic="xy", mass=2, temperature=1.5, seed=5)
TEMPERATURE = 1.5 * 60 / 58
"""T = 2E/D with D = 2N - 2."""


def test_correlation_is_a_mean_over_starts():
    draw = np.random.default_rng(1)
    series = draw.normal(size=(23, 4)) + 1j * draw.normal(size=(23, 4))
    slow = [np.mean([(series[t + lag] * series[t].conj()).real.sum() for t in range(16)]) for lag in range(8)]
    assert correlation(series, 8) == pytest.approx(slow)


@pytest.mark.parametrize(("starts", "step"), [(64, 0.05), (2, 0.02)], ids=["all starts", "gaps"])
def test_sums_against_states(make, monkeypatch, starts, step):
    """One segment by hand, from the states of the log; read in groups of instants, with every other disc's own part."""
    monkeypatch.setattr("idealgas.analysis.scattering.sums.STARTS", starts)
    log = make("run.collisions_per_disc=40")
    window = idealgas.analyse(log, "scattering", start=0.0).window
    monkeypatch.setattr("idealgas.tallies.stream.PLACES_AT_ONCE", 300)
    k, lags = 2 * math.pi / 9, 17
    most = len(read(log, window, k, step, lags).at) * 15
    monkeypatch.setattr("idealgas.analysis.scattering.sums.MOST_PLACES", most)
    series = read(log, window, k, step, lags)
    edges = np.linspace(0, 2, 31)
    *_, result = segments(log, k, lags, series, edges)
    apart = int((window.duration / step - lags + 2) / 32)
    assert (series.starts, series.places.shape[2]) == (starts if starts < 64 else apart, 15)
    assert (np.diff(series.at) == 1).all() == (starts == 64)
    states = [log.state_at(window.start + step * (31 * apart + n)) for n in range(series.starts + lags - 1)]
    position = np.array([state.position for state in states])
    unwrapped = position + 9 * np.array([state.image for state in states])
    velocity = np.array([state.velocity for state in states])
    lag, pairs = 5, [(t + 5, t) for t in range(series.starts)]
    found = dict.fromkeys(("density", "along", "across", "own"), 0.0)
    for axis in range(2):
        wave = np.exp(-1j * k * position[:, :, axis])
        for name, weight in (("density", 1.0), ("along", velocity[:, :, axis]), ("across", velocity[:, :, 1 - axis])):
            total = (weight * wave).sum(axis=1)
            found[name] += np.mean([(total[later] * total[t].conj()).real for later, t in pairs]) / 60
        own = wave[:, ::2]
        found["own"] += np.mean([(own[later] * own[t].conj()).real.mean() for later, t in pairs]) / 2
    got = result.density[lag], result.longitudinal[lag], result.transverse[lag], result.self_part[lag]
    assert got == pytest.approx(tuple(found.values()))
    apart = [unwrapped[t + 16, ::2] - unwrapped[t, ::2] for t in range(series.starts)]
    distance = np.hypot(*np.moveaxis(apart, 2, 0)).ravel()
    assert result.moments[4] == pytest.approx(((distance**2).mean(), (distance**4).mean()))
    assert result.distances == pytest.approx(np.histogram(distance, edges)[0] / len(distance))


@pytest.fixture(scope="module")
def found(log):
    return idealgas.scattering(log)


def test_exact_values_and_continuity(found):
    """Currents at t = 0 and F_s after a short time by theory, k = 4; -d²F/dt² = k² C_L and α₂(0) = -2/(D + 2)."""
    assert found.thermal_speed == pytest.approx(math.sqrt(TEMPERATURE / 2))
    assert [round(wave.k * 9 / (2 * math.pi)) for wave in found.waves] == [1, 2, 4, 9]
    for wave in found.waves:
        square = TEMPERATURE / 2 * (1 - wave.structure.value / 30)
        assert (wave.longitudinal_square.theory, wave.transverse_square.theory) == pytest.approx((square, square))
        for estimate in (wave.longitudinal_square, wave.transverse_square, wave.early):
            assert estimate.theory is None or abs(estimate.deviation) < 4
        step, current = wave.time[1], wave.k**2 * wave.longitudinal.value
        slope = np.append(0.0, np.cumsum(step * (current[1:] + current[:-1]) / 2))
        fall = np.append(0.0, np.cumsum(step * (slope[1:] + slope[:-1]) / 2))
        noise = 4 * np.hypot(wave.density.error, wave.density.error[0])
        assert (np.abs(wave.density.value[0] - wave.density.value - fall) < noise + 0.01)[:16].all()
        assert wave.self_part.value[0] == pytest.approx(1, rel=1e-12)
    assert any(wave.early.theory is not None for wave in found.waves)
    assert abs(found.non_gaussian.value[0] + 2 / 60) < 4 * found.non_gaussian.error[0] + 0.01


def test_that_errors_are_too_small_is_said(found):
    assert "up to 1.3 times too small" in found.caveats[0]


def test_displacements_are_normal_but_for_their_non_gaussian_parameter(found):
    """∫ G_s d²r = 1 up to 3 rms, exp(-9) beyond; the bins against a normal distribution times 1 + α₂ L₂(r²/⟨Δr²⟩).

    The expansion in Laguerre polynomials L₂(x) = 1 - 2x + x²/2: Rahman, Phys. Rev. 136, A405 (1964), here in 2-D; its
    next terms are below 0.1 of the density. k = 5 as 30 bins of 4 times are compared.
    """
    assert [each.time for each in found.van_hove] == [wave.time[16] for wave in found.waves]
    for each in found.van_hove:
        width = each.distance[1] - each.distance[0]
        share = 2 * math.pi * each.distance * width * each.density.value
        assert share.sum() == pytest.approx(1, abs=0.005)
        x = each.distance**2 / each.square
        where = np.argmin(np.abs(found.time - each.time))
        assert found.time[where] == pytest.approx(each.time, rel=0.3)
        expected = each.gaussian * (1 + found.non_gaussian.value[where] * (1 - 2 * x + x**2 / 2))
        near = x < 4
        assert (np.abs(each.density.value - expected) < 5 * each.density.error + 0.1 * each.gaussian)[near].all()


@pytest.mark.parametrize("drift", [(0.0, 0.0), (3.0, -0.5)])
def test_other_discs_against_states(log, drift, monkeypatch):
    """Pairs by hand, at the instants of two segments of two starts each, relative to the centre of mass."""
    state = log.state_at(0.0)
    discs = [
        f"{{ position = {place}, velocity = {velocity}, radius = 0.5, mass = 2 }}"
        for place, velocity in zip(state.position.tolist(), (state.velocity + drift).tolist(), strict=True)
    ]
    moving = log_of(GAS, f"disc=[{', '.join(discs)}]", "species=", "run={until=20}")
    window = Window(np.array([5.0, 20.0]), 0, False)
    monkeypatch.setattr("idealgas.analysis.scattering.distinct.SEGMENTS", 2)
    monkeypatch.setattr("idealgas.analysis.scattering.distinct.STARTS", 2)
    times, starts = [0.0, 0.3, 2.0], np.linspace(5, 18, 4)
    found = distinct_parts(moving, window, times)
    places = {at: moving.state_at(at).position for start in starts for at in start + np.array(times)}
    for time, each in zip(times, found, strict=True):
        edges = np.append(each.distance - 0.025, each.distance[-1] + 0.025)
        assert edges == pytest.approx(np.arange(len(edges)) / 20, abs=1e-12)
        assert edges[-1] <= 4.5 < edges[-1] + 0.05
        parts = []
        for start in starts:
            apart = places[start + time] - time * np.array(drift) - places[start][:, None]
            apart -= 9 * np.rint(apart / 9)
            distance = np.hypot(*np.moveaxis(apart, 2, 0))[~np.eye(30, dtype=bool)]
            parts.append(np.histogram(distance, edges)[0] / (30 * math.pi * np.diff(edges**2)))
        first, second = np.mean(parts[:2], axis=0), np.mean(parts[2:], axis=0)
        assert each.density.value == pytest.approx((first + second) / 2)
        assert each.density.error == pytest.approx(abs(first - second) / 2)


def test_other_discs_from_pairs_to_chance(log, found):
    """G_d is ρ g(r) at t = 0, with instants of its own, and (N - 1)/A long after; k = 5 as 300 bins are compared."""
    assert [each.time for each in found.distinct] == [0.0, *(own.time for own in found.van_hove)]
    start, (pairs,) = found.distinct[0], idealgas.transport(log).pair_distributions
    assert (start.density.value[:20] == 0).all()
    n = min(len(pairs.value), len(start.distance) - 20)
    assert (pairs.edges[:n] + 0.025)[:n] == pytest.approx(start.distance[20 : 20 + n], rel=0.01)
    density = 30 / 81 * (1 - 1 / 30)
    error = np.hypot(start.density.error[20 : 20 + n], density * pairs.error[:n])
    assert (np.abs(start.density.value[20 : 20 + n] - density * pairs.value[:n]) < 5 * error).all()
    (late,) = distinct_parts(log, found.window, [found.window.duration / 8])
    assert (np.abs(late.density.value - 29 / 81) < 5 * late.density.error).all()
    share = 2 * math.pi * late.distance * 0.05
    error = math.sqrt(((share * late.density.error) ** 2).sum())
    assert abs((share * (late.density.value - 29 / 81)).sum()) < 4 * error + 0.01
    assert start.density.value[20] > 1.5 * 29 / 81


def test_a_single_disc_has_no_others(make):
    log = make("species.gas.count=1", "run.collisions_per_disc=", "run.until=50")
    assert distinct_parts(log, None, [0.0]) == ()


def test_structure_is_that_of_order(log, found):
    """S(k) of the longest waves from instants of its own; k = 4."""
    structure, (wave, *_) = idealgas.order(log).structure, found.waves
    assert structure.k[0] == pytest.approx(wave.k)
    error = math.hypot(structure.error[0], wave.structure.standard_error)
    assert abs(structure.value[0] - wave.structure.value) < 4 * error


def test_spectrum_has_the_structure_as_its_integral(found):
    """∫ S(k, ω) dω/2π = S(k): sum over the frequencies of the transform, exactly but for those left out."""
    for wave in found.waves:
        integral = (2 * wave.spectrum.value[1:].sum() + wave.spectrum.value[0]) * wave.frequency[1] / (2 * math.pi)
        assert integral == pytest.approx(wave.structure.value, rel=0.03)
