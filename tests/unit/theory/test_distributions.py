import math

import numpy as np
import pytest
from scipy import integrate, stats

from idealgas.theory import distributions, hard_discs

T, M = 1.7, 2.3

LAWS = {
    "energy": (distributions.EnergyLaw(T), 0, 30 * T),
    "energy, D = 10": (distributions.EnergyLaw(T, 10), 0, 5 * T),
    "speed": (distributions.SpeedLaw(T, M), 0, 10),
    "speed, D = 10": (distributions.SpeedLaw(T, M, 10), 0, math.sqrt(10 * T / M)),
    "component": (distributions.ComponentLaw(T, M), -10, 10),
    "component, D = 10": (distributions.ComponentLaw(T, M, 10), -math.sqrt(10 * T / M), math.sqrt(10 * T / M)),
    "free time": (distributions.FreeTimeLaw(T, M, (M,), (0.8,)), 0, 80),
    "free path": (distributions.FreePathLaw(T, M, (M,), (0.8,)), 0, 80),
    "free path, mixture": (distributions.FreePathLaw(T, M, (M, 9.0), (0.8, 2.0)), 0, 40),
    "waiting-time": (distributions.WaitingTimeLaw(3.0), 0, 20),
}


@pytest.mark.parametrize("law", LAWS)
def test_density_distribution_and_mean_go_together(law):
    law, low, high = LAWS[law]
    assert integrate.quad(law.pdf, low, high, limit=200)[0] == pytest.approx(1, abs=1e-8)
    assert integrate.quad(lambda x: x * law.pdf(x), low, high, limit=200)[0] == pytest.approx(law.mean, abs=1e-7)
    for share in (0.02, 0.1, 0.3, 0.7):
        x = low + share * (high - low)
        assert integrate.quad(law.pdf, low, x, limit=200)[0] == pytest.approx(law.cdf(x), abs=1e-8)
    assert law.cdf(low) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("dof", [10, 40])
def test_laws_at_fixed_energy_are_those_of_a_sphere(dof):
    point = np.random.default_rng(dof).normal(size=(40_000, dof))
    point *= np.sqrt(T * dof / (point**2).sum(axis=1, keepdims=True))  # Σ m v² = 2E = T D
    velocity = point[:, :2] / math.sqrt(M)
    speed = np.hypot(*velocity.T)
    for sample, law in (
        (speed, distributions.SpeedLaw(T, M, dof)),
        (velocity[:, 1], distributions.ComponentLaw(T, M, dof)),
        (M * speed**2 / 2, distributions.EnergyLaw(T, dof)),
    ):
        assert stats.kstest(sample, law.cdf).pvalue > 0.001
    assert stats.kstest(speed, distributions.SpeedLaw(T, M).cdf).pvalue < (1e-3 if dof == 10 else 1)


def test_maxwell_is_the_limit_of_many_degrees_of_freedom():
    x = np.linspace(0, 5, 50)
    for law in (distributions.SpeedLaw, distributions.ComponentLaw):
        assert law(T, M, 1e7).cdf(x) == pytest.approx(law(T, M).cdf(x), abs=1e-6)


def test_nothing_beyond_the_total_energy():
    law = distributions.SpeedLaw(T, M, 10)
    fastest = math.sqrt(10 * T / M)
    assert law.cdf(np.array([fastest, 2 * fastest])).tolist() == [1.0, 1.0]
    assert law.pdf(np.array([2 * fastest])).tolist() == [0.0]


@pytest.mark.parametrize("speed", [0.0, 0.5, 1.0, 4.0])
def test_mean_relative_speed_at_a_speed(speed):
    # ⟨|v - u|⟩ over u of two normal components with variance T/m
    def integrand(angle, u):
        distance = math.sqrt(speed**2 + u**2 - 2 * speed * u * math.cos(angle))
        return distance * M * u / T * math.exp(-M * u**2 / (2 * T)) / math.pi

    expected = integrate.dblquad(integrand, 0, 12, 0, math.pi)[0]
    assert distributions.mean_relative_speed_at(speed, T, M) == pytest.approx(expected, rel=1e-6)


def test_free_flights_have_the_rates_of_kinetic_theory():
    rate = hard_discs.collision_rate(1.0, 0.01, T, M, 0.01 * math.pi / 4)
    path = hard_discs.mean_free_path(1.0, 0.01, 0.01 * math.pi / 4)
    assert distributions.FreeTimeLaw(T, M, (M,), (rate,)).mean == pytest.approx(1 / rate, rel=1e-12)
    assert distributions.FreePathLaw(T, M, (M,), (rate,)).mean == pytest.approx(path, rel=1e-12)


def test_free_time_law_against_a_simulated_poisson_process():
    # discs take thermal speeds weighted by ν(v), then fly for an exponential time of rate ν(v)
    rng = np.random.default_rng(4)
    speed = np.hypot(*rng.normal(scale=math.sqrt(T / M), size=(2, 200_000)))
    rate = 0.8 * distributions.mean_relative_speed_at(speed, T, M) / math.sqrt(math.pi * T / M)
    chosen = rng.random(len(rate)) < rate / rate.max()
    time = rng.exponential(1 / rate[chosen])
    assert stats.kstest(time, distributions.FreeTimeLaw(T, M, (M,), (0.8,)).cdf).pvalue > 0.001
    assert stats.kstest(time * speed[chosen], distributions.FreePathLaw(T, M, (M,), (0.8,)).cdf).pvalue > 0.001
    assert stats.kstest(time, stats.expon(scale=1 / 0.8).cdf).pvalue < 1e-6
