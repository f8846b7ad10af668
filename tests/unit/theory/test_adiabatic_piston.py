"""Two gases that exchange energy by the fluctuations of a piston between them: closed forms."""

import math

import numpy as np
import pytest

from idealgas.theory.adiabatic_piston import conductance, heat_flow, relaxation, slowest_rate

pytestmark = pytest.mark.interpreted


def test_conductance():
    """4 · 3/16 · 5 √(2/1 + 6/3)/(2 √(2π))."""
    assert conductance(2.0, 6.0, 5.0, 1.0, 3.0) == pytest.approx(3.75 / math.sqrt(2 * math.pi), rel=1e-14)
    assert conductance(2.0, 6.0, 5.0, 3.0, 1.0) == pytest.approx(3.75 / 2 * math.sqrt(20 / 3 / 2 / math.pi), rel=1e-14)


@pytest.mark.parametrize(
    ("conductances", "capacities", "rate"),
    [
        ([0.5], [2.0, 4.0], 0.5 * (1 / 2 + 1 / 4)),
        ([1.0, 1.0], [1.0, 1.0, 1.0], 1.0),  # a chain of three: 0, 1 and 3
        ([1.0, 0.0], [1.0, 1.0, 1.0], 2.0),
        ([1.0, 1.0], [1.0, 0.5, 1.0], 1.0),
        ([1.0, 2.0], [1.0, 1.0, 1.0], 3 - math.sqrt(3)),  # λ² - 6 λ + 6
        ([0.0], [2.0, 4.0], 0.0),
    ],
)
def test_slowest_rates_of_chains(conductances, capacities, rate):
    assert slowest_rate(np.array(conductances), np.array(capacities)) == pytest.approx(rate, rel=1e-12)


def test_heat_flows_from_the_hot_gas_to_the_cold_one():
    """A heavy piston comes to √(T₁T₂) = 2, and the gas of T = 1 takes 4 m/M F/√(2π) (2 - 1)."""
    cold, hot = heat_flow(np.array([1.0, 4.0]), 5.0, 1.0, 1e7)
    assert cold == pytest.approx(4e-7 * 5 / math.sqrt(2 * math.pi), rel=1e-6)
    assert hot == pytest.approx(-cold, rel=1e-6)
    assert heat_flow(np.array([3.0, 3.0]), 5.0, 1.0, 2.0) == pytest.approx([0, 0], abs=1e-14)
    light = heat_flow(np.array([1.0, 4.0]), 5.0, 1.0, 2.0)
    assert light.sum() == pytest.approx(0, abs=1e-9)


def test_relaxation():
    """Of the heat 1/(1 + Z) warms a gas, at first by this rate; the energy stays, and temperatures become equal."""
    first, number = np.array([1.0, 4.0]), np.array([10, 30])
    force = 1.5 * 130 / 20
    slope = heat_flow(first, force, 1.0, 10.0) / 2.5 / number
    early = relaxation(first, number, 1.0, 10.0, 1.5, 20.0, np.linspace(0, 1e-4, 3))
    assert (early[:, -1] - first) / 1e-4 == pytest.approx(slope, rel=1e-3)
    late = relaxation(first, number, 1.0, 10.0, 1.5, 20.0, np.linspace(0, 1600, 1601))
    assert number @ late == pytest.approx(np.full(1601, 130.0), rel=1e-6)
    assert late[:, -1] == pytest.approx([3.25, 3.25], rel=1e-6)
    halved = relaxation(first, number, 1.0, 10.0, 1.5, 20.0, np.linspace(0, 1600, 3201))
    assert late == pytest.approx(halved[:, ::2], rel=1e-6)  # of the fourth order
