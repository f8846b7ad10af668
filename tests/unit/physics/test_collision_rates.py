"""Henderson's contact value against fractions, and the rate of Monte Carlo trials against kinetic theory."""

import math
from fractions import Fraction

import numpy as np
import pytest
from helpers.rounding import gamma

from idealgas.physics.collision_rates import (
    collisions_per_length,
    contact_value,
    disc_collisions_per_length,
    mean_trial_time,
)
from idealgas.theory.hard_discs import collision_rate, mean_relative_speed

pytestmark = pytest.mark.interpreted


def test_contact_value():
    """8 roundings: two above, where the product's count less, three doubled by the square below, a quotient."""
    for phi in np.linspace(0, 0.9, 91).tolist():
        exact = (1 - Fraction(7, 16) * Fraction(phi)) / (1 - Fraction(phi)) ** 2
        assert abs(Fraction(contact_value(phi)) - exact) <= gamma(8) * exact
    assert contact_value(0.0) == 1.0
    phi = np.array([0.0, 0.1, 0.5])
    assert contact_value(phi) == pytest.approx([contact_value(p) for p in phi.tolist()], rel=gamma(4))


@pytest.mark.parametrize(("n", "radius"), [(1000, 0.02), (50, 0.3)])
def test_trials_accepted_at_equilibrium_speeds_give_the_rate_of_kinetic_theory(n, radius):
    area, mass, temperature, v_ref = 100.0, 2.0, 3.0, 40.0
    phi = n * math.pi * radius**2 / area
    duration = mean_trial_time(n, area, phi, 2 * radius, v_ref)
    accepted = mean_relative_speed(temperature, mass) / v_ref
    expected = collision_rate(2 * radius, (n - 1) / area, temperature, mass, phi)
    assert 2 * accepted / duration / n == pytest.approx(expected, rel=1e-13)


def test_collisions_of_all_discs_per_length():
    """√2 · 0.4 · 9/200 χ for each of ten discs, and 2/π over the room of the largest one between opposite sides."""
    pairs = math.sqrt(2) * 0.4 * 9 / 200 * contact_value(0.2)
    assert disc_collisions_per_length(10, 0.4, 0.2, (20.0, 10.0)) == pytest.approx(pairs, rel=1e-14)
    dense = math.sqrt(2) * 0.4 * 9 / 200 * contact_value(0.9)
    assert disc_collisions_per_length(10, 0.4, 0.95, (20.0, 10.0)) == pytest.approx(dense, rel=1e-14)
    for size, periodic, sides in (
        ((20.0, 10.0), (False, False), 2 / math.pi * (1 / 19 + 1 / 9)),
        ((200.0, 1.0), (False, False), 2 / math.pi / 199),  # no room for two: the others are left out
        ((200.0, 1.0), (False, True), 2 / math.pi * (1 / 199 + 1)),
    ):
        result = collisions_per_length(10, 0.4, 0.5, 0.2, size, periodic)
        assert result == pytest.approx(10 * (pairs + sides), rel=1e-14)
