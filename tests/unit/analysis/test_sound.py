"""Sound: the law of a wave against its limits, correlations against a slow sum, and which gases are refused."""

from itertools import pairwise

import numpy as np
import pytest
from helpers.logs import gas

from idealgas import sound
from idealgas.analysis.sound import _amplitudes, _wave, correlations
from idealgas.theory.waves import Decay, Fluid, correlation, fit, sound_of_discs

FLUID = Fluid(speed=2.8, damping=2.5, spreading=2.4, exponent=2.1)
TIME = np.linspace(0.0, 40.0, 201)


@pytest.mark.parametrize("k", [0.01, 0.2, 1.0, 5.0])
def test_every_correlation_begins_at_one_and_level(k):
    step = 1e-6 / k
    first, second = correlation(np.array([0.0, step]), k, FLUID)
    assert first == pytest.approx(1.0, abs=1e-12)
    assert (first - second) / step < 1e-3 * FLUID.speed * k


def test_long_waves_are_heat_and_sound():
    """To lowest order: heat is (γ - 1)/γ of the wave, and sound goes on with the speed c."""
    k = 1e-3
    time = np.linspace(0.0, 3 / (FLUID.damping * k**2), 400)
    heat, damping = np.exp(-FLUID.spreading * k**2 * time), np.exp(-FLUID.damping * k**2 * time)
    known = (1 - 1 / FLUID.exponent) * heat + damping / FLUID.exponent * np.cos(FLUID.speed * k * time)
    assert correlation(time, k, FLUID) == pytest.approx(known, abs=2e-3)


def test_a_fit_finds_the_fluid():
    guess = Decay(0.3, 0.2, Fluid(2.2, 3.5, 1.5, 1.7))
    thermal = 0.25 * FLUID.speed**2 / FLUID.exponent
    result = fit(TIME, Decay(0.25, 0.2, FLUID).at(TIME), guess, thermal)
    assert (result.size, *result.fluid) == pytest.approx((0.25, *FLUID), rel=1e-6)


@pytest.mark.parametrize("phi", [1e-9, 1e-4])
def test_sound_of_a_dilute_gas_is_adiabatic(phi):
    """With Z = 1 + 2φ both Z² and d(φZ)/dφ are 1 + 4φ, to an error of 20 φ²."""
    fluid = sound_of_discs(phi, temperature=3.0, mass=2.0, diameter=1.0)
    assert (fluid.exponent, fluid.speed) == pytest.approx((2.0, np.sqrt(2 * (1 + 4 * phi) * 3.0 / 2.0)), rel=1e-6)


def test_correlations_are_averages_over_the_starts_of_each_part():
    draw = np.random.default_rng(1)
    waves = draw.normal(size=(2, 50)) + 1j * draw.normal(size=(2, 50))
    result = correlations(waves, lags=8, segments=5)
    edges = [0, 8, 17, 25, 34, 43]
    for part, (first, last) in enumerate(pairwise(edges)):
        for lag in range(8):
            slow = [(waves[a, t + lag] * waves[a, t].conjugate()).real for a in range(2) for t in range(first, last)]
            assert result[part, lag] == pytest.approx(np.mean(slow))


GAS = gas(20, 0.5, (10, 8), "collisions_per_disc = 300", periodic="xy")


def test_amplitudes_are_sums_over_discs_and_errors_those_of_a_jackknife(log, monkeypatch):
    """The jackknife error of a mean of parts is their standard deviation over √n."""
    times = np.array([0.0, 0.3 * log.end_time, log.end_time])
    places = np.array([state.position for state in log.frames(times)])
    expected = np.exp(-2j * np.pi * places / log.box).sum(axis=1).T
    assert _amplitudes(log, times, (0, 1), None) == pytest.approx(expected, abs=1e-9)
    linear = lambda lag, result, guess, thermal: Decay(1.0, guess.k, Fluid(*result[:4]))  # noqa: E731
    monkeypatch.setattr("idealgas.analysis.sound.fit", linear)
    draw = np.random.default_rng(1).normal(size=(2, 1, 200))
    wave = _wave(log, (0,), (Decay(1.0, 1.0, FLUID), None), np.arange(4.0), draw[0] + 1j * draw[1])
    estimates = (wave.speed, wave.damping, wave.spreading, wave.exponent)
    assert [estimate.value for estimate in estimates] == pytest.approx(wave.correlation)
    assert [estimate.standard_error for estimate in estimates] == pytest.approx(wave.error, rel=1e-9)


def test_a_wave_in_a_small_box_is_said_to_be_no_wave_of_a_fluid(make):
    log = make("box.bottom=reflecting", "box.top=reflecting", "run.collisions_per_disc=1000")
    result = sound(log, start=0.0)
    (wave,) = result.waves
    assert (wave.axes, wave.wavelength) == ("x", 10.0)
    assert any("mean free paths or diameters long" in sentence for sentence in result.caveats)


def test_a_speed_that_is_hardly_known_is_said_to_be(log, monkeypatch):
    part = max(wave.speed.standard_error / wave.speed.value for wave in sound(log, start=0.0).waves)
    for rough, said in ((0.99, True), (1.01, False)):
        monkeypatch.setattr("idealgas.analysis.sound.ROUGH", rough * part)
        assert any("is known to" in sentence for sentence in sound(log, start=0.0).caveats) == said
