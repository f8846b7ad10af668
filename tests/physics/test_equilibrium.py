"""Long runs against theory: kinetic theory and the equation of state within 4 standard errors, speeds by KS at 0.001.

The seeds are fixed. What a run must at least resolve is asserted too, so that the tests can fail.
"""

import math

import numpy as np
import pytest
from helpers.against_theory import LEAST_P, STANDARD_ERRORS, all_agree
from helpers.logs import gas, log_of, species

from idealgas import histogram
from idealgas.analysis.heat_capacity import HeatCapacityAnalysis
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.temperature import temperature
from idealgas.columns import SIDES
from idealgas.theory import hard_discs


def scene(number, packing_fraction, collisions_per_disc, seed, temperature=1.0):
    radius = math.sqrt(packing_fraction * 100 / (math.pi * number))
    return gas(
        number, radius, (10, 10), f"collisions_per_disc = {collisions_per_disc}", temperature=temperature, seed=seed
    )


@pytest.fixture(scope="module", params=[0.01, 0.1, 0.3], ids="phi={}".format)
def million(request):
    """A million collisions of a thousand discs."""
    return log_of(scene(1000, request.param, 2000, seed=11))


@pytest.fixture(scope="module")
def channel():
    """Six discs of the energy 1 each, in a frame where the momentum along the periodic axis is zero."""
    return log_of(gas(6, 0.3, (6, 6), "collisions_per_disc = 5000", periodic="x", seed=3))


def test_every_collision_is_a_contact_and_energy_does_not_drift(million):
    """To 1e-12 of a diameter: clocks are rounded by u times the way in an epoch, up to 6144 diameters.

    A collision changes the energy by rounding, u or so of two discs' share: a million stay far below 1e-12.
    """
    blocks = list(million.chunks(("disc", "partner", "position")))
    disc, partner, position = (
        np.concatenate(column) for column in zip(*((b.disc, b.partner, b.position) for b in blocks), strict=True)
    )
    first = np.flatnonzero(partner > disc.astype(np.int64))
    assert len(first) == 1_000_000
    distance = np.hypot(*(position[first] - position[first + 1]).T)
    assert np.abs(distance / (2 * million.discs.radius[0]) - 1).max() <= 1e-12
    assert million.summary["deepest_overlap"] <= 1e-12
    energy = million.observables["kinetic_energy"][1]
    assert len(energy) > 10
    assert np.abs(energy / energy[0] - 1).max() <= 1e-12


def test_pressure_collision_rate_and_free_path(million):
    all_agree(million, 0.1, "pressure", "routes.*_wall*.compressibility_factor")
    all_agree(million, 1e-3, "pressure", "routes.pairs_virial.compressibility_factor")
    all_agree(million, 1e-2, "pressure", "routes.walls_virial.compressibility_factor")
    all_agree(million, 2e-3, "pressure", "collision_rates.*.rate")
    all_agree(million, 3e-3, "pressure", "free_paths.*")
    assert pressure(million).check().agrees


@pytest.mark.parametrize("quantity", ["speed", "vx", "vy", "energy"])
def test_velocities(million, quantity):
    (result,) = histogram(million, quantity).distributions
    assert result.samples > 5_000
    assert all(test.p_value > LEAST_P for test in result.tests)


@pytest.mark.parametrize("quantity", ["free-path", "free-time", "waiting-time"])
def test_free_flights_and_waits(million, quantity):
    """The laws are those of many discs in a dilute gas, and have errors of their own."""
    (result,) = histogram(million, quantity).distributions
    assert result.samples > 4_000
    (test,) = result.tests
    assert test.p_value > LEAST_P
    assert test.law_error < 0.012


def test_small_gas_tells_fixed_energy_from_maxwell():
    """Four discs have eight degrees of freedom, and no speed beyond √(2E/m)."""
    log = log_of(scene(4, 0.05, 40_000, seed=2))
    (result,) = histogram(log, "speed").distributions
    maxwell, finite = result.tests
    assert maxwell.p_value < 1e-6
    assert finite.p_value > LEAST_P


def test_mixture():
    """Equipartition from unequal temperatures, and the rates at which two masses and radii meet."""
    light = gas(600, 0.05, (10, 10), "collisions_per_disc = 1500", name="light", temperature=1.5, seed=3)
    log = log_of(light + species("heavy", 300, 0.1, mass=4.0, temperature=0.2))
    all_agree(log, 0.02, "temperature", "species.light.*", "species.heavy.*")
    all_agree(log, 0.01, "pressure", "collision_rates.*.rate")
    assert pressure(log).check().agrees


@pytest.mark.parametrize("quantity", ["vx", "vy", "speed", "energy"])
def test_few_discs_with_momentum_along_one_axis(channel, quantity):
    """Six equal discs have 11 degrees of freedom: 2E/11 across, and 5/6 of it along the periodic axis."""
    (gas,) = histogram(channel, quantity).distributions
    fixed_energy = gas.tests[-1]
    assert fixed_energy.law_name == "fixed energy (11 degrees of freedom)"
    assert fixed_energy.p_value > LEAST_P
    if quantity != "energy":
        return
    result = temperature(channel)
    assert (result.species[0].x.theory, result.species[0].y.theory) == pytest.approx((10 / 11, 12 / 11), rel=1e-9)
    for estimate in (result.species[0].x, result.species[0].y):
        assert estimate.standard_error < 0.01
        assert abs(estimate.deviation) < STANDARD_ERRORS
    assert result.law == "T = 1.09091 (2E/D with D = 11), T(1 - m/M) along x"


def test_few_discs_in_a_heat_bath():
    """Speeds and rates of Maxwell and Boltzmann's law, not of four discs that share a fixed energy: 3 % faster."""
    sides = [f"box.{side}={{ thermal = 1 }}" for side in SIDES]
    log = log_of(gas(4, 0.03, (1, 1), "events = 300_000", temperature=3, seed=7), *sides)
    result = pressure(log)
    (flight,) = result.free_paths
    all_agree(log, 0.006, "pressure", "collision_rates.*.rate", "free_paths.*")
    fixed = flight.speed.theory * hard_discs.finite_speed_factor(8)
    assert fixed - flight.speed.value > 10 * flight.speed.standard_error
    assert result.check().agrees


def test_heat_capacity_is_the_number_of_discs():
    logs = [log_of(scene(500, 0.1, 400, seed=20 + k, temperature=t)) for k, t in enumerate((0.5, 1.0, 1.5, 2.0))]
    routes = HeatCapacityAnalysis.combine([HeatCapacityAnalysis.measure(log) for log in logs]).routes
    assert [route.name for route in routes] == ["dE/dT", "E/T"]
    for route in routes:
        assert abs(route.value.deviation) < STANDARD_ERRORS
        assert route.value.standard_error < 0.03
