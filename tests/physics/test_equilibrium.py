"""Long runs against theory: kinetic theory and the equation of state within 4 standard errors, speeds by KS at 0.001.

The seeds are fixed. What a run must at least resolve is asserted too, so that the tests can fail.
"""

import math

import numpy as np
import pytest
from helpers.against_theory import LEAST_P, STANDARD_ERRORS

from idealgas import histogram
from idealgas.analysis.heat_capacity import HeatCapacityAnalysis
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.temperature import temperature
from idealgas.analysis.theory import hard_discs
from idealgas.log import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene


def scene(number, packing_fraction, collisions_per_disc, seed, temperature=1.0):
    radius = math.sqrt(packing_fraction * 100 / (math.pi * number))
    return parse_scene(f"""
        scene.seed = {seed}
        box.size = [10, 10]
        species = [{{name = "gas", count = {number}, radius = {radius!r}, temperature = {temperature}}}]
        run.collisions_per_disc = {collisions_per_disc}
    """)


@pytest.fixture(scope="module", params=[0.01, 0.1, 0.3], ids="phi={}".format)
def million(request, tmp_path_factory):
    """A million collisions of a thousand discs."""
    path = tmp_path_factory.mktemp("million") / "run.h5"
    simulate(scene(1000, request.param, 2000, seed=11), path)
    with open_log(path) as log:
        yield log
    path.unlink()


@pytest.fixture(scope="module")
def channel(tmp_path_factory):
    """Six discs of the energy 1 each, in a frame where the momentum along the periodic axis is zero."""
    path = tmp_path_factory.mktemp("channel") / "run.h5"
    simulate(
        parse_scene("""
            scene.seed = 3
            box = { size = [6, 6], left = "periodic", right = "periodic" }
            species = [{ name = "gas", count = 6, radius = 0.3, temperature = 1 }]
            run.collisions_per_disc = 5000
        """),
        path,
    )
    with open_log(path) as log:
        yield log
    path.unlink()


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
    result = pressure(million)
    z = {route.name: route.compressibility_factor for route in result.routes}
    for name, estimate in z.items():
        assert abs(estimate.deviation) < STANDARD_ERRORS, name
    assert z["pairs, virial"].standard_error < 1e-3 * z["pairs, virial"].value
    assert z["walls, virial"].standard_error < 1e-2 * z["walls, virial"].value
    (rate,), (flight,) = result.collision_rates, result.free_paths
    for estimate in (rate.rate, flight.path, flight.time, flight.speed):
        assert abs(estimate.deviation) < STANDARD_ERRORS
        assert estimate.standard_error < 3e-3 * estimate.value
    assert rate.rate.standard_error < 2e-3 * rate.rate.value
    assert result.check().agrees


@pytest.mark.parametrize("quantity", ["speed", "vx", "vy", "energy"])
def test_velocities(million, quantity):
    (found,) = histogram(million, quantity).distributions
    assert found.samples > 5_000
    assert all(test.p_value > LEAST_P for test in found.tests)


@pytest.mark.parametrize("quantity", ["free-path", "free-time", "waiting-time"])
def test_free_flights_and_waits(million, quantity):
    """The laws are those of many discs in a dilute gas, and have errors of their own."""
    (found,) = histogram(million, quantity).distributions
    assert found.samples > 4_000
    (test,) = found.tests
    assert test.p_value > LEAST_P
    assert test.law_error < 0.012


def test_small_gas_tells_fixed_energy_from_maxwell(run):
    """Four discs have eight degrees of freedom, and no speed beyond √(2E/m)."""
    log = run(scene(4, 0.05, 40_000, seed=2))
    (found,) = histogram(log, "speed").distributions
    maxwell, finite = found.tests
    assert maxwell.p_value < 1e-6
    assert finite.p_value > LEAST_P


def test_mixture(run):
    """Equipartition from unequal temperatures, and the rates at which two masses and radii meet."""
    text = """
        scene.seed = 3
        box.size = [10, 10]
        run.collisions_per_disc = 1500
        [[species]]
        name = "light"
        count = 600
        radius = 0.05
        temperature = 1.5
        [[species]]
        name = "heavy"
        count = 300
        radius = 0.1
        mass = 4.0
        temperature = 0.2
    """
    log = run(parse_scene(text))
    temperatures, pressures = temperature(log), pressure(log)
    for entry in temperatures.species[:-1]:
        for estimate in (entry.x, entry.y, entry.both):
            assert abs(estimate.deviation) < STANDARD_ERRORS, entry.species
            assert estimate.standard_error < 0.02 * estimate.value
    for rate in pressures.collision_rates:
        assert abs(rate.rate.deviation) < STANDARD_ERRORS, (rate.species, rate.other)
        assert rate.rate.standard_error < 0.01 * rate.rate.value
    assert pressures.check().agrees


@pytest.mark.parametrize("quantity", ["vx", "vy", "speed", "energy"])
def test_few_discs_with_momentum_along_one_axis(channel, quantity):
    """Six equal discs have 11 degrees of freedom: 2E/11 across, and 5/6 of it along the periodic axis."""
    (gas,) = histogram(channel, quantity).distributions
    fixed_energy = gas.tests[-1]
    assert fixed_energy.law_name == "fixed energy (11 degrees of freedom)"
    assert fixed_energy.p_value > LEAST_P
    if quantity != "energy":
        return
    found = temperature(channel)
    assert (found.species[0].x.theory, found.species[0].y.theory) == pytest.approx((10 / 11, 12 / 11), rel=1e-9)
    for estimate in (found.species[0].x, found.species[0].y):
        assert estimate.standard_error < 0.01
        assert abs(estimate.deviation) < STANDARD_ERRORS
    assert found.law == "T = 1.09091 (2E/D with D = 11), T(1 - m/M) along x"


def test_few_discs_in_a_heat_bath(tmp_path):
    """Speeds and rates of Maxwell and Boltzmann's law, not of four discs that share a fixed energy: 3 % faster."""
    sides = "".join(f"box.{side} = {{ thermal = 1 }}\n" for side in ("left", "right", "bottom", "top"))
    species = 'species = [{ name = "gas", count = 4, radius = 0.03, temperature = 3 }]'
    simulate(
        parse_scene(f"scene.seed = 7\nbox.size = [1, 1]\n{sides}{species}\nrun.events = 300_000"), tmp_path / "run.h5"
    )
    with open_log(tmp_path / "run.h5") as log:
        result = pressure(log)
    (rate,), (flight,) = result.collision_rates, result.free_paths
    for estimate in (rate.rate, flight.path, flight.time, flight.speed):
        assert abs(estimate.deviation) < STANDARD_ERRORS
        assert estimate.standard_error < 0.006 * estimate.value
    fixed = flight.speed.theory * hard_discs.finite_speed_factor(8)
    assert fixed - flight.speed.value > 10 * flight.speed.standard_error
    assert result.check().agrees


def test_heat_capacity_is_the_number_of_discs(tmp_path):
    logs = []
    for k, t in enumerate((0.5, 1.0, 1.5, 2.0)):
        path = tmp_path / f"{t}.h5"
        simulate(scene(500, 0.1, 400, seed=20 + k, temperature=t), path)
        logs.append(open_log(path))
    routes = HeatCapacityAnalysis.combine([HeatCapacityAnalysis.measure(log) for log in logs]).routes
    for log in logs:
        log.close()
    assert [route.name for route in routes] == ["dE/dT", "E/T"]
    for route in routes:
        assert abs(route.value.deviation) < STANDARD_ERRORS
        assert route.value.standard_error < 0.03
