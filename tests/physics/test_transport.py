"""Transport coefficients of periodic gases against Enskog's theory, and sound against them, from several runs.

Minutes for each state; run by hand.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
from helpers.logs import gas, log_of, species

from idealgas import sound
from idealgas.analysis.transport.measure import Transport, transport
from idealgas.statistics.estimates import Estimate, mean_of_replicates

STANDARD_ERRORS = 3
"""Largest difference between two directions, in its standard errors."""

PLAIN = "log.compression = 'none'"
RESOLVED = 0.015
"""Largest standard error of a coefficient, relative."""


def measure(number: int, phi: float, seed: int, collisions_per_disc: int) -> Transport:
    radius, run = math.sqrt(phi / (number * math.pi)), f"collisions_per_disc = {collisions_per_disc}"
    log = log_of(gas(number, radius, (1, 1), run, periodic="xy", placement="lattice", seed=seed, then=PLAIN))
    return transport(log, start=100 * log.end_time / collisions_per_disc)


def over_theory(result: list[Estimate]) -> Estimate:
    return mean_of_replicates([each.times(1 / each.theory) for each in result])


FIXED = {"viscosity": 2.0, "thermal_conductivity": 6.0}
"""Part by which N discs of a dilute gas have smaller currents at fixed energy and momentum, times N.

⟨(Σ m v_x v_y)²⟩ is N T² (1 - 1/N)²; ⟨(Σ m v² v_x)²⟩ is smaller by (1 - 1/N)(1 - 2/N) and, in D = 2N - 2 degrees of
freedom, by D²/(D + 2)(D + 4).
"""


@pytest.mark.long
@pytest.mark.parametrize(
    ("phi", "number", "seeds", "within"),
    [(0.01, 500, range(1000, 1012), 0.02)]
    + [(phi, 250, range(1000, 1008), 0.05) for phi in (0.05, 0.1, 0.2)]
    + [(phi, 250, range(1000, 1008), 0.08) for phi in (0.3, 0.4)],
)
def test_enskog(phi, number, seeds, within):
    actual = [measure(number, phi, seed, 20_000).collective for seed in seeds]
    for name, part in FIXED.items():
        ones = [each.coefficients[name] for each in actual]
        ratio = over_theory([each.value for each in ones])
        if phi == 0.01:
            ratio = ratio.times(1 / (1 - part / number))
        print(f"φ = {phi}, N = {number}: {name} over Enskog's {ratio.value:.4f} ± {ratio.standard_error:.4f}")
        assert ratio.standard_error < RESOLVED
        assert abs(ratio.value - 1) < within
        apart = mean_of_replicates([each.difference for each in ones])
        assert abs(apart.value) < STANDARD_ERRORS * apart.standard_error


@pytest.mark.long
@pytest.mark.parametrize(("mass", "radius"), [(1.0, 0.2), (4.0, 0.2), (10.0, 0.4)])
def test_two_species_in_each_other(mass, radius):
    """Two halves of 200 discs diffuse in each other as Enskog has it, at φ = 0.02 to 0.05; three standard errors."""
    heavy, result = species("heavy", 100, radius, mass=mass), []
    for seed in range(1, 9):
        light = gas(100, 0.2, (35, 35), "collisions_per_disc = 10_000", periodic="xy", seed=seed, then=PLAIN)
        log = log_of(light + heavy)
        result.append(transport(log).collective.coefficients["mutual_diffusion"])
    ratio = over_theory([each.value for each in result])
    print(f"masses 1 : {mass:g}, radii 0.2 : {radius}: D₁₂ over Enskog's {ratio}")
    assert ratio.standard_error < 2 * RESOLVED
    error = result[0].value.theory_error / result[0].value.theory
    assert abs(ratio.value - 1) < STANDARD_ERRORS * math.hypot(ratio.standard_error, error)
    apart = mean_of_replicates([each.difference for each in result])
    assert abs(apart.value) < STANDARD_ERRORS * apart.standard_error


def test_a_heavy_disc_among_few_light_ones():
    """A disc that has half of the mass, in a dilute periodic gas, where Enskog's friction γ is right.

    m⟨v²⟩/2 is T(1 - m/M), and as the others recoil, the velocity decays at γ/(1 - m/M): twice as fast as among many.
    Twelve windows of one run; three standard errors.
    """
    light = gas(20, 0.5, (40, 40), "collisions_per_disc = 40_000", periodic="xy", seed=1, then=PLAIN)
    heavy = species("heavy", 1, 0.5, mass=20)
    log = log_of(light.replace("[[species]]", f"{heavy}[[species]]"))
    edges = np.linspace(0, log.end_time, 13)
    actual = [transport(log, *window).diffusion[0] for window in pairwise(edges)]
    temperature, light = 2 * log.discs.kinetic_energy / 40, 20 / 1600
    reduced = 20 / 21
    chi = 1.0163  # (1 - 7φ/16)/(1 - φ)² at φ = .0103
    rate = 2 * light * chi * math.sqrt(math.pi * temperature / (2 * reduced))
    time = 0.5 / (2 * reduced / 20 * rate)
    for estimates, theory in (
        ([each.velocity_correlation_time for each in actual], time),
        ([each.coefficient for each in actual], temperature * 0.5 / 20 * time),
    ):
        assert estimates[0].theory == pytest.approx(theory, rel=0.02)  # terms of 1/D
        assert estimates[0].theory_error < 0.05 * theory
        measured = mean_of_replicates(estimates)
        assert measured.standard_error < 0.15 * theory
        assert abs(measured.value - theory) < STANDARD_ERRORS * measured.standard_error
        print(measured, theory)


SIDE, NUMBER, SEEDS = 80.0, 2400, range(1, 7)
SOUND = gas(NUMBER, 0.5, (SIDE, SIDE), "until = 6400", periodic="xy", then=PLAIN)


@pytest.mark.long
def test_the_chain_agrees_with_itself():
    """Speed within 2 % of the equation of state's, damping within 10 % of what the coefficients give, and 4 s.e."""
    waves, chain = [], []
    density = NUMBER / SIDE**2
    for seed in SEEDS:
        log = log_of(SOUND, f"scene.seed={seed}")
        waves.append(sound(log).waves[0])
        currents = transport(log, end=1500.0).collective.coefficients
        actual = {name: current.value.value for name, current in currents.items()}
        gamma = waves[-1].exponent.theory
        heat = actual["thermal_conductivity"] / (density * gamma)
        chain.append(((actual["viscosity"] + actual["bulk_viscosity"]) / density + (gamma - 1) * heat) / 2)
    speed, damping = (mean_of_replicates([getattr(wave, name) for wave in waves]) for name in ("speed", "damping"))
    assert speed.standard_error < 0.005 * speed.value
    assert abs(speed.value / speed.theory - 1) < 0.02
    assert damping.standard_error < 0.05 * damping.value
    assert abs(damping.value / np.mean(chain) - 1) < 0.1 + 2 * damping.standard_error / damping.value
