"""Boltzmann's H and the entropy of positions: exact biases, equilibrium, and gases on their way there."""

import math

import numpy as np
import pytest
from helpers.logs import PERIODIC, gas

import idealgas
from idealgas.analysis.entropy import _bias, neighbour_entropy

GAS = gas(40, 0.1, (10, 10), "collisions_per_disc = 60", mass=2, temperature=1.5, seed=2)


@pytest.mark.parametrize(("number", "samples"), [(8, 4000), (30, 4000), (300, 1000)])
def test_exact_bias_of_normal_points(number, samples):
    """Mean of many samples of independent normal points; entropy 1 + ln 2π, k = 4."""
    draw = np.random.default_rng(number)
    result = np.array([neighbour_entropy(draw.normal(size=(number, 2))) for _ in range(samples)])
    error = result.std(ddof=1) / math.sqrt(samples)
    assert abs(result.mean() - _bias(number) - 1 - math.log(2 * math.pi)) < 4 * error
    assert math.isnan(neighbour_entropy(np.zeros((number, 2))))  # of points that coincide


@pytest.mark.parametrize("sides", [(), PERIODIC])
def test_equilibrium(make, sides):
    """At a fixed energy, with and without conserved momentum: H = -1 - ln(2πT/m) with T = 2E/D, k = 4."""
    (result,) = idealgas.entropy(make(*sides)).species
    temperature = 1.5 * (80 / 78 if sides else 1)
    assert result.mean_h.theory == pytest.approx(-1 - math.log(math.pi * temperature), rel=1e-9)
    assert abs(result.mean_h.deviation) < 4
    assert abs(result.mean_positions.deviation) < 4
    assert result.cells == (2, 1)


@pytest.mark.slow
def test_in_a_heat_bath(make):
    log = make("thermostat={temperature=3, rate=1}", "run.collisions_per_disc=", "run.until=200")
    (result,) = idealgas.entropy(log).species
    assert result.mean_h.theory == pytest.approx(-1 - math.log(3 * math.pi))
    assert abs(result.mean_h.deviation) < 4


def test_equal_speeds_become_maxwells(make):
    """H falls from that of speeds on a circle; discs in one half have ln 2 less entropy, and none less at the end."""
    many = ("species.gas.count=400", "species.gas.radius=0.03", "species.gas.temperature=", "species.gas.speed=1")
    free = ("species.gas.region=[0, 0, 5, 10]", "wall=[{from=[5, 0], to=[5, 10], opens_at=1}]")
    (result,) = idealgas.entropy(make(*many, *free, "run.collisions_per_disc=20")).species
    assert result.h[0] > result.mean_h.value + 2
    assert result.positions[0] == pytest.approx(-math.log(2), abs=0.05)
    assert result.positions[-1] == pytest.approx(0, abs=0.05)


def test_a_cooling_gas_has_no_equilibrium(make):
    result = idealgas.entropy(make("restitution.normal=0.9"), start=1.0, end=6.0)
    assert (result.time[0], result.time[-1]) == (1.0, 6.0)
    (gas,) = result.species
    assert gas.mean_h is None
    assert gas.h[-1] > gas.h[0]  # colder: fewer velocities


def test_without_positions(make):
    log = make("run.method=monte_carlo", "run.collisions_per_disc=", "run.trials=20_000")
    (result,) = idealgas.entropy(log).species
    assert result.positions is None
    assert abs(result.mean_h.deviation) < 4
