"""Columns of few discs at fixed energy against integrals over the energy surface that can be done by hand."""

import math

import numpy as np
import pytest

from idealgas.theory.barometric import barometric_temperature, column_rates, fixed_energy_column

pytestmark = pytest.mark.interpreted

PULL = 0.7


@pytest.mark.parametrize(("number", "dof"), [(3, 6), (3, 9), (5, 9), (20, 40), (1000, 1999)])
def test_a_tall_column(number, dof):
    """Each height adds a factor E' to the number of states, so that T = (E - m g h)/(D/2 + N - 1), to whose power n is.

    The lid is above what the energy reaches. To 1e-6: the integral ends where the integrand is that small.
    """
    mass, energy = 1.3, 4.0 * number
    (result,) = fixed_energy_column(energy, dof, np.array([mass]), np.array([number]), PULL, np.array([1e6]))
    left = energy - mass * PULL * result.above
    assert result.above[-1] == pytest.approx(energy / (mass * PULL))
    assert result.temperature[:-1] == pytest.approx(left[:-1] / (dof / 2 + number - 1), rel=1e-6, abs=1e-6)
    assert result.density == pytest.approx((left / energy) ** (dof / 2 + number - 2), abs=1e-6)


def test_two_discs_below_a_lid():
    """D = 4: the density is ∫ (E' - m g h) dh over the heights of the other, T its integral over E' divided by it."""
    energy, height, mass = 2.5, np.array([1.5, 1.2]), np.array([1.0, 2.0])
    for s, result in enumerate(fixed_energy_column(energy, 4, mass, np.ones(2, int), PULL, height)):
        left, other = energy - mass[s] * PULL * result.above, mass[1 - s] * PULL
        most = np.minimum(other * height[1 - s], left)
        states, energies = left * most - most**2 / 2, (left**3 - (left - most) ** 3) / 6
        assert result.density == pytest.approx(states / states[0], abs=2e-5)
        assert result.temperature == pytest.approx(energies / states, abs=2e-5)


def test_many_discs_below_a_lid_are_a_barometric_column():
    """T differs from that of the mean energy by terms of 1/N, densities by (m g h/T)²/2, up to 50, over D/2 + N."""
    mass, number, height = np.array([1.0, 3.0]), np.array([3000, 1000]), np.array([4.0, 3.9])
    energy = 6000.0
    t = barometric_temperature(energy, 8000, mass, number, PULL, height)
    for m, result in zip(mass, fixed_energy_column(energy, 8000, mass, number, PULL, height), strict=True):
        assert result.temperature == pytest.approx(t, rel=10 / 4000)
        assert result.density == pytest.approx(np.exp(-m * PULL * result.above / t), rel=50 / 8000)


def test_rates_of_a_column_that_hardly_falls():
    """One disc meets no other, and the sides of its room of 9.8 by 4.8 at the rate n⟨v⟩/π of their length."""
    result = column_rates(2.0, np.array([3.0]), np.array([0.1]), np.array([1.0]), 1e-9, 10.0, 5.0)
    assert (result.pairs, result.per_disc.tolist()) == (0.0, [0.0])
    flux = math.sqrt(math.pi * 2 / (2 * 3)) / math.pi / (9.8 * 4.8)
    assert result.hits == pytest.approx(flux * 2 * (9.8 + 4.8), rel=2e-3)  # of 2000 layers
    two = column_rates(2.0, np.array([3.0]), np.array([0.1]), np.array([2.0]), 1e-9, 10.0, 5.0)
    assert two.hits == pytest.approx(2 * result.hits, rel=1e-12)
    rate = 2 * 0.2 * math.sqrt(math.pi * 2 / 3) / (9.8 * 4.8)  # 2σ⟨v_rel⟩/A with the other one
    assert two.per_disc[0] == pytest.approx(rate, rel=3e-3)
    assert two.pairs == pytest.approx(two.per_disc[0], rel=1e-14)
