"""Laws of discs that lose energy in collisions, against the collision rule itself and against what must come out."""

import math

import numpy as np
import pytest

from idealgas.theory.granular import (
    GranularParameters,
    cooling_per_collision,
    cooling_time,
    fourth_cumulant,
    homogeneous_cooling,
    loss_of_motion,
    loss_of_spin,
    relaxation,
    temperature_ratio,
)


def test_perfectly_rough_discs_share_their_energy():
    for kappa in (0.2, 0.5, 1.0):
        rough = GranularParameters(1.0, 1.0, kappa)
        assert temperature_ratio(rough) == pytest.approx(1, rel=1e-12)
        assert loss_of_motion(rough, 1.0) == pytest.approx(0, abs=1e-15)


def test_smooth_discs():
    assert temperature_ratio(GranularParameters(0.9)) is temperature_ratio(GranularParameters(0.9, -1.0, 0.5)) is None
    assert relaxation(GranularParameters(0.9)) == 0
    assert loss_of_spin(GranularParameters(0.9, -1.0, 0.5), 3.0) == 0
    assert fourth_cumulant(math.sqrt(0.5)) == pytest.approx(0, abs=1e-15)
    assert fourth_cumulant(0.9) == pytest.approx(-992 / 36_930, rel=1e-13)
    assert fourth_cumulant(0.8) == pytest.approx(-896 / 40_840, rel=1e-13)
    assert fourth_cumulant(0.5) == pytest.approx(4 / 48.25, rel=1e-13)
    e, rate = 0.9, 2.5
    a2, smooth = fourth_cumulant(e), GranularParameters(e)
    assert cooling_time(smooth, rate) == pytest.approx(4 / ((1 - e**2) * rate * (1 + 3 * a2 / 16)), rel=1e-14)
    assert cooling_per_collision(smooth) == pytest.approx((1 - e**2) / 2 * (1 + a2 / 4), rel=1e-3)  # to first order
    time = np.array([0.0, 10.0])
    t, s = homogeneous_cooling(smooth, rate, 2.0, 0.7, time)
    assert t == pytest.approx(2 / (1 + time / cooling_time(smooth, rate)) ** 2, rel=1e-14)
    assert s.tolist() == [0.7, 0.7]


@pytest.mark.parametrize(
    "parameters",
    [
        GranularParameters(0.8),
        GranularParameters(0.9, 0.3, 0.5),
        GranularParameters(0.7, -0.4, 0.2),
        GranularParameters(1.0, 1.0, 0.5),
    ],
)
@pytest.mark.parametrize("x", [0.0, 0.4, 2.0])
def test_losses_are_means_over_collisions(parameters, x):
    """A million collisions at T = m = R = 1, with impulses by the rule; 4 standard errors."""
    random, n = np.random.default_rng(5), 1_000_000
    kappa = parameters.inertia or 1.0
    g_n = math.sqrt(2) * np.sqrt(2 * random.exponential(size=n))  # speed of approach, weighted with itself
    g_t = math.sqrt(2) * random.normal(size=n)  # along the surfaces
    omega = math.sqrt(x / kappa) * random.normal(size=(2, n))
    slip = g_t + omega.sum(axis=0)
    along = -(1 + parameters.normal) / 2 * g_n
    across = -(1 + parameters.roughness) * slip * kappa / (1 + kappa) / 2
    motion = along * g_n + along**2 + across * g_t + across**2  # change of the energy of both discs
    spin = across * omega.sum(axis=0) + across**2 / kappa
    for result, energy, share in (
        (loss_of_motion(parameters, x), motion, 0.5),
        (loss_of_spin(parameters, x), spin, 1.0),
    ):
        error = share * energy.std() / math.sqrt(n)
        assert abs(-share * energy.mean() - result) <= 4 * error + 1e-15


def test_rough_discs_at_their_ratio_follow_haff():
    parameters, rate, time = GranularParameters(0.9, 0.5, 0.5), 1.3, np.linspace(0, 300, 50)
    ratio = temperature_ratio(parameters)
    t, s = homogeneous_cooling(parameters, rate, 2.0, 2.0 * ratio, time)
    assert t == pytest.approx(2 / (1 + time / cooling_time(parameters, rate)) ** 2, rel=1e-3)
    assert s / t == pytest.approx(ratio, rel=1e-3)


def test_rough_discs_come_to_their_ratio():
    parameters = GranularParameters(0.95, 0.0, 0.5)
    ratio, folds = temperature_ratio(parameters), relaxation(parameters)
    t, s = homogeneous_cooling(parameters, 1.0, 1.0, 1.2 * ratio, np.linspace(0, 2000, 100_000))
    x = s / t
    lost = -np.log(t) / loss_of_motion(parameters, ratio)  # collisions, about
    reached = lost[np.flatnonzero(x - ratio < 0.2 * ratio / math.e)[0]]
    assert reached == pytest.approx(folds, rel=0.1)  # the ratio is 20 % off at first
    assert x[-1] == pytest.approx(ratio, rel=1e-3)
