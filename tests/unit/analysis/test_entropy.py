"""Boltzmann's H and the entropy of positions: exact biases, equilibrium, and gases on their way there."""

import math

import numpy as np
import pytest

import idealgas
from idealgas.analysis.entropy import _bias, neighbour_entropy
from idealgas.errors import NotApplicableError

GAS = """
scene.seed = 2
box.size = [10, 10]
run.collisions_per_disc = 60
species = [{ name = "gas", count = 40, radius = 0.1, mass = 2, temperature = 1.5 }]
"""


@pytest.mark.parametrize(("number", "samples"), [(8, 4000), (30, 4000), (300, 1000)])
def test_exact_bias_of_normal_points(number, samples):
    """Mean of many samples of independent normal points; entropy 1 + ln 2π, k = 4."""
    draw = np.random.default_rng(number)
    found = np.array([neighbour_entropy(draw.normal(size=(number, 2))) for _ in range(samples)])
    error = found.std(ddof=1) / math.sqrt(samples)
    assert abs(found.mean() - _bias(number) - 1 - math.log(2 * math.pi)) < 4 * error


def test_points_that_coincide_have_no_entropy():
    assert math.isnan(neighbour_entropy(np.zeros((10, 2))))


@pytest.mark.parametrize("sides", [(), tuple(f"box.{side}='periodic'" for side in ("left", "right", "bottom", "top"))])
def test_equilibrium(make, sides):
    """At a fixed energy, with and without conserved momentum: H = -1 - ln(2πT/m) with T = 2E/D, k = 4."""
    (found,) = idealgas.entropy(make(*sides)).species
    temperature = 1.5 * (80 / 78 if sides else 1)
    assert found.mean_h.theory == pytest.approx(-1 - math.log(math.pi * temperature), rel=1e-9)
    assert abs(found.mean_h.deviation) < 4
    assert abs(found.mean_positions.deviation) < 4
    assert found.cells == (2, 1)


@pytest.mark.slow
def test_in_a_heat_bath(make):
    log = make("thermostat={temperature=3, rate=1}", "run.collisions_per_disc=", "run.until=200")
    (found,) = idealgas.entropy(log).species
    assert found.mean_h.theory == pytest.approx(-1 - math.log(3 * math.pi))
    assert abs(found.mean_h.deviation) < 4


def test_equal_speeds_become_maxwells(make):
    """H falls from that of speeds on a circle; discs in one half have ln 2 less entropy, and none less at the end."""
    many = ("species.gas.count=400", "species.gas.radius=0.03", "species.gas.temperature=", "species.gas.speed=1")
    free = ("species.gas.region=[0, 0, 5, 10]", "wall=[{from=[5, 0], to=[5, 10], opens_at=1}]")
    (found,) = idealgas.entropy(make(*many, *free, "run.collisions_per_disc=20")).species
    assert found.h[0] > found.mean_h.value + 2
    assert found.positions[0] == pytest.approx(-math.log(2), abs=0.05)
    assert found.positions[-1] == pytest.approx(0, abs=0.05)


def test_start_and_end(make):
    found = idealgas.entropy(make(), start=1.0, end=2.0)
    assert (found.time[0], found.time[-1]) == (1.0, 2.0)


def test_a_cooling_gas_has_no_equilibrium(make):
    (found,) = idealgas.entropy(make("restitution.normal=0.9")).species
    assert found.mean_h is None
    assert found.h[-1] > found.h[0]  # colder: fewer velocities


def test_without_positions(make):
    log = make("run.method=monte_carlo", "run.collisions_per_disc=", "run.trials=20_000")
    (found,) = idealgas.entropy(log).species
    assert found.positions is None
    assert abs(found.mean_h.deviation) < 4


def test_too_few_discs(make):
    with pytest.raises(NotApplicableError, match="entropy requires events and a species of at least 8 discs"):
        idealgas.entropy(make("species.gas.count=7"))
