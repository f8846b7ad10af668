"""Times of slow exchanges against independent formulas, their caveats, and the errors that contain them."""

import math

import numpy as np
import pytest
from helpers.logs import gas, log_of, species

from idealgas import profile, temperature
from idealgas.analysis.caveats import window_caveats
from idealgas.tallies.exchange import INDEPENDENT, across, through_pistons
from idealgas.theory import enskog, hard_discs
from idealgas.theory.adiabatic_piston import relaxation, slowest_rate

RADIUS = math.sqrt(0.4 / (60 * math.pi))
DENSE = gas(60, RADIUS, (1, 1), "collisions_per_disc = 40", seed=1)
PISTON = gas(
    40, 0.05, (20, 10), "until = 60", name="left", region=[0, 0, 8, 10], seed=4,
    then='piston = [{ inner = "x", position = 8, mass = 20 }]',
) + species("right", 60, 0.05, region=[8, 0, 20, 10])  # fmt: skip


def test_heat_crosses_a_box_by_enskogs_conductivity():
    """L²/2a with a = λ/(n c_P) and c_P = 1 + Z²/(d(φZ)/dφ), Z of the hard-disc fluid; a quarter of it if periodic."""
    log = log_of(DENSE)
    z, slope = (float(f(0.4)) for f in (hard_discs.compressibility_factor, hard_discs.inverse_compressibility))
    conductivity = enskog.conductivity(2 * RADIUS, 60, 1.0, 1.0, (z - 1) / 0.8)
    diffusivity = conductivity / (60 * (1 + z**2 / slope))
    result = across(log, 0)
    assert result.process == "heat crosses the box along x"
    assert result.time == pytest.approx(1 / (2 * diffusivity), rel=0.01)
    periodic = log_of(DENSE, "box.left=periodic", "box.right=periodic")
    assert across(periodic, 0).time == pytest.approx(result.time / 4, rel=0.01)
    assert across(periodic, 1).time == pytest.approx(result.time, rel=0.01)


def test_a_short_profile_names_the_time_of_its_slowest_exchange():
    log = log_of(DENSE)
    result = profile(log, "x", 4)
    (said,) = [sentence for sentence in result.caveats if "relaxes slowly" in sentence]
    assert f"heat crosses the box along x in t = {across(log, 0).time:.2g}" in said
    assert result.window.slowest == across(log, 0)
    assert not window_caveats(temperature(log).window)  # the temperature of all discs has no such exchange


def test_unlike_discs_diffuse_more_slowly_than_heat():
    """Equal discs with two names: self-diffusion by Enskog's theory, D = T/(m Γ)."""
    half = f"count = 30, radius = {RADIUS!r}, temperature = 1"
    log = log_of(DENSE, f"species=[{{ name = 'a', {half} }}, {{ name = 'b', {half} }}]")
    rate = hard_discs.collision_rate(2 * RADIUS, 60, 1.0, 1.0, 0.4)
    assert across(log, 1).process == "discs diffuse across the box along y"
    assert across(log, 1).time == pytest.approx(rate / 2, rel=0.02)


def test_temperatures_beside_a_piston_approach_each_other_at_the_slowest_rate():
    """The end of `relaxation`, which integrates kinetic theory in time, and the rate from conductance and capacity."""
    log = log_of(PISTON)
    result = through_pistons(log)
    assert result.process == "energy crosses the inner pistons"
    number, z = np.array([40, 60]), hard_discs.compressibility_factor(math.pi * 0.05**2 / 2)
    time = np.linspace(0.0, result.time / 2, 200)  # one correlation time
    left, right = relaxation(np.array([1.01, 1 - 0.01 * 40 / 60]), number, 1.0, 20.0, float(z), 20.0, time)
    assert (left - right)[-1] / (left - right)[0] == pytest.approx(math.exp(-1), rel=0.05)
    assert slowest_rate(np.array([2.0]), np.array([3.0, 6.0])) == pytest.approx(2 * (1 / 3 + 1 / 6))
    assert slowest_rate(np.array([0.0]), np.array([3.0, 0.0])) == 0
    chain = slowest_rate(np.array([1.0, 1.0]), np.ones(3))  # -1, 0, 1 decays at 1, 1, -2, 1 at 3
    assert chain == pytest.approx(1.0)


def test_temperature_of_a_gas_beside_a_piston_has_the_error_of_the_exchange():
    """In a short window a temperature scatters by T √((1 - n/N)/2n) of n dilute discs, whatever the window shows."""
    log = log_of(PISTON)
    result = temperature(log, start=0.0)
    (said,) = window_caveats(result.window)
    assert f"energy crosses the inner pistons in t = {result.window.slowest.time:.2g}" in said
    for entry, number in zip(result.species[:2], (40, 60), strict=True):
        spread = math.sqrt((1 - number / 100) / (2 * number))
        assert 0.9 * spread < entry.both.standard_error < 1.02 * spread
        assert math.isinf(entry.both.independent_samples)
    assert result.species[2].both.standard_error < 0.02  # of all discs
    assert result.window.duration < INDEPENDENT * result.window.slowest.time


def test_shear_stress_between_smooth_walls_is_what_the_gas_beside_them_loses():
    """Momentum along smooth walls does not leave the gas: 0 on average, with an error far below that of its scatter."""
    log = log_of(DENSE, "box.bottom=periodic", "box.top=periodic", "run.collisions_per_disc=200")
    result = profile(log, "x", 5)
    naive = profile(log_of(DENSE, "run.collisions_per_disc=200"), "x", 5)
    for of_strip, other in zip(result.pressure["xy"], naive.pressure["xy"], strict=True):
        assert abs(of_strip.value) < 4 * of_strip.standard_error
        assert of_strip.standard_error < 0.8 * other.standard_error
