"""Laws of discs that lose energy in collisions, against the collision rule itself and against what must come out."""

import math

import numpy as np
import pytest

from idealgas.analysis.theory.granular import (
    Grains,
    cooling_per_collision,
    cooling_time,
    fourth_cumulant,
    homogeneous_cooling,
    loss_of_motion,
    loss_of_spin,
    relaxation,
    temperature_ratio,
)


@pytest.mark.parametrize("grains", [Grains(0.8), Grains(0.9, 0.3, 0.5), Grains(0.7, -0.4, 0.2), Grains(1.0, 1.0, 0.5)])
@pytest.mark.parametrize("x", [0.0, 0.4, 2.0])
def test_losses_are_means_over_collisions(grains, x):
    """A million collisions at T = m = R = 1, with impulses by the rule; 4 standard errors."""
    random, n = np.random.default_rng(5), 1_000_000
    kappa = grains.inertia or 1.0
    g_n = math.sqrt(2) * np.sqrt(2 * random.exponential(size=n))  # speed of approach, weighted with itself
    g_t = math.sqrt(2) * random.normal(size=n)  # along the surfaces
    omega = math.sqrt(x / kappa) * random.normal(size=(2, n))
    slip = g_t + omega.sum(axis=0)
    along = -(1 + grains.normal) / 2 * g_n
    across = -(1 + grains.roughness) * slip * kappa / (1 + kappa) / 2
    motion = along * g_n + along**2 + across * g_t + across**2  # change of the energy of both discs
    spin = across * omega.sum(axis=0) + across**2 / kappa
    for found, energy, share in ((loss_of_motion(grains, x), motion, 0.5), (loss_of_spin(grains, x), spin, 1.0)):
        error = share * energy.std() / math.sqrt(n)
        assert abs(-share * energy.mean() - found) <= 4 * error + 1e-15


def test_perfectly_rough_discs_share_their_energy():
    for kappa in (0.2, 0.5, 1.0):
        rough = Grains(1.0, 1.0, kappa)
        assert temperature_ratio(rough) == pytest.approx(1, rel=1e-12)
        assert loss_of_motion(rough, 1.0) == pytest.approx(0, abs=1e-15)


def test_smooth_discs():
    assert temperature_ratio(Grains(0.9)) is temperature_ratio(Grains(0.9, -1.0, 0.5)) is None
    assert relaxation(Grains(0.9)) == 0
    assert loss_of_spin(Grains(0.9, -1.0, 0.5), 3.0) == 0
    assert fourth_cumulant(math.sqrt(0.5)) == pytest.approx(0, abs=1e-15)
    e, rate = 0.9, 2.5
    a2 = fourth_cumulant(e)
    assert cooling_time(Grains(e), rate) == pytest.approx(4 / ((1 - e**2) * rate * (1 + 3 * a2 / 16)), rel=1e-14)
    assert cooling_per_collision(Grains(e)) == pytest.approx((1 - e**2) / 2 * (1 + a2 / 4), rel=1e-3)  # to first order
    time = np.array([0.0, 10.0])
    t, s = homogeneous_cooling(Grains(e), rate, 2.0, 0.7, time)
    assert t == pytest.approx(2 / (1 + time / cooling_time(Grains(e), rate)) ** 2, rel=1e-14)
    assert s.tolist() == [0.7, 0.7]


def test_rough_discs_at_their_ratio_follow_haff():
    grains, rate, time = Grains(0.9, 0.5, 0.5), 1.3, np.linspace(0, 300, 50)
    ratio = temperature_ratio(grains)
    t, s = homogeneous_cooling(grains, rate, 2.0, 2.0 * ratio, time)
    assert t == pytest.approx(2 / (1 + time / cooling_time(grains, rate)) ** 2, rel=1e-3)
    assert s / t == pytest.approx(ratio, rel=1e-3)


def test_rough_discs_come_to_their_ratio():
    grains = Grains(0.95, 0.0, 0.5)
    ratio, folds = temperature_ratio(grains), relaxation(grains)
    t, s = homogeneous_cooling(grains, 1.0, 1.0, 1.2 * ratio, np.linspace(0, 2000, 100_000))
    x = s / t
    lost = -np.log(t) / loss_of_motion(grains, ratio)  # collisions, about
    reached = lost[np.flatnonzero(x - ratio < 0.2 * ratio / math.e)[0]]
    assert reached == pytest.approx(folds, rel=0.1)  # the ratio is 20 % off at first
    assert x[-1] == pytest.approx(ratio, rel=1e-3)
