"""Equilibrium of a gas by its conserved quantities, against exact sums and against points of the energy surface."""

import math
from fractions import Fraction

import numpy as np
import pytest
from helpers.support import gas_of
from scipy import stats

from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene
from idealgas.theory.ensemble import Composition, Ensemble, classes, composition, equilibrium

MIXTURE = """
box.size = [8, 6]
run.until = 1
species = [
    { name = "heavy", count = 2, radius = 0.2, mass = 5, temperature = 1 },
    { name = "light", count = 4, radius = 0.1, mass = 1, temperature = 2 },
]
"""
ALONG_X = ("box.left=periodic", "box.right=periodic")
ALL = (*ALONG_X, "box.bottom=periodic", "box.top=periodic")
HEAVY, LIGHT = 9 / 14, 13 / 14  # 1 - m/M with M = 2 * 5 + 4 * 1


def ensemble_of(*overrides):
    """Ensemble of the mixture, and its kinetic energy in the frame of the conserved momentum."""
    scene = parse_scene(MIXTURE, overrides=overrides)
    gas = make_gas(scene)
    ensemble = equilibrium(scene, gas, 0.0)
    relative = gas.velocity - ensemble.centre_of_mass_velocity
    return ensemble, float(gas.mass @ (relative**2).sum(axis=1)) / 2


@pytest.mark.parametrize(
    ("overrides", "dof", "heavy", "light"),
    [
        ((), 12, (1, 1), (1, 1)),
        (ALONG_X, 11, (HEAVY, 1), (LIGHT, 1)),
        (ALL, 10, (HEAVY, HEAVY), (LIGHT, LIGHT)),
        ((*ALONG_X, "box.top={ thermal = 3 }"), math.inf, (1, 1), (1, 1)),
        ((*ALL, "thermostat={ temperature = 3, rate = 1 }"), math.inf, (1, 1), (1, 1)),
        ((*ALONG_X, "wall=[{ from = [4, 1], to = [4, 2] }]"), 12, (1, 1), (1, 1)),
        ((*ALL, "rotation.roughness=1"), 16, (HEAVY, HEAVY), (LIGHT, LIGHT)),
        ((*ALONG_X, "rotation={ roughness = -1, wall_roughness = 1 }"), 18, (1, 1), (1, 1)),
    ],
)
def test_conserved_momentum_by_axis(overrides, dof, heavy, light):
    """T = 2E/D, and T(1 - m/M) along the axes where the total momentum is conserved; 3 in a heat bath."""
    ensemble, energy = ensemble_of(*overrides)
    temperature = 3.0 if math.isinf(dof) else 2 * energy / dof
    assert ensemble.dof == dof
    assert ensemble.temperature == pytest.approx(temperature, rel=1e-12)
    assert ensemble.of_axes == pytest.approx(temperature * np.array([heavy, light]), rel=1e-12)
    if math.isfinite(dof) and "rotation" not in str(overrides):  # the parts are the whole
        assert np.array([2, 4]) @ ensemble.of_species == pytest.approx(energy, rel=1e-12)


@pytest.mark.parametrize("mass", [1e16, 1e30])
@pytest.mark.parametrize(
    ("count", "overrides", "dof", "fixed"),
    [
        (1, (), 8, 0),
        (1, ALL, 8, 1),  # recoils with the momentum of the others, and has 4 T/M
        (2, ALL, 8, 0),
        (2, (*ALL, "thermostat={ temperature = 3, rate = 1 }"), math.inf, None),
    ],
)
def test_fixed_discs_take_no_energy(mass, count, overrides, dof, fixed):
    """Four light discs have 8 degrees of freedom among discs that are too heavy to move in any run."""
    at_rest = ("species.heavy.temperature=", "species.heavy.speed=0", f"species.heavy.mass={mass}")
    ensemble, energy = ensemble_of(*overrides, *at_rest, f"species.heavy.count={count}")
    temperature = 2 * energy / 8 if fixed is not None else 3
    assert ensemble.dof == dof
    assert ensemble.of_axes[1] == pytest.approx(temperature, rel=1e-12)
    expected = temperature if fixed is None else 4 / mass * temperature * fixed
    assert ensemble.of_axes[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("mass", [1e3, 1e12, 1e16, 1e30])
def test_no_digits_are_lost_beside_a_heavy_disc(mass):
    """Against exact fractions, to rounding: four additions and one division."""
    gas = gas_of((9, 9), np.zeros((6, 2)), 0.0, 0.1, mass=[mass, 0.3, 0.3, 0.3, 0.7, 0.7])
    gas = gas.__class__(**{**vars(gas), "species": np.array([0, 1, 1, 1, 2, 2]), "species_names": ("a", "b", "c")})
    whole = sum(map(Fraction, gas.mass))
    exact = [float((whole - Fraction(m)) / whole) for m in (mass, 0.3, 0.7)]
    assert composition(gas).mass_share_of_others == pytest.approx(exact, rel=1e-15)


def discs_of(mass):
    """Species of these masses, one disc of each."""
    return Composition(("",) * len(mass), np.ones(len(mass)), mass, np.ones(len(mass)), np.arange(len(mass)))


def test_classes_keep_the_area_and_the_masses_of_discs_that_differ():
    radius = np.random.default_rng(1).uniform(0.3, 0.7, 5000)
    gas = gas_of((900, 900), np.zeros((5000, 2)), 0.0, radius, mass=radius**2)
    result = classes(gas)
    assert len(result.radius) == 32
    assert result.packing_fraction(result.number / gas.area) == pytest.approx(gas.packing_fraction, rel=1e-13)
    assert result.number @ result.mass == pytest.approx(gas.mass.sum(), rel=1e-13)
    assert result.number @ result.radius / 5000 == pytest.approx(radius.mean(), rel=1e-4)
    assert result.shares @ result.mass**-0.5 == pytest.approx([(1 / radius).mean()], rel=1e-3)
    assert [len(classes(gas_of((9, 9), np.zeros((n, 2)), 0.0, radius[:n])).radius) for n in (1, 3, 50)] == [1, 3, 32]


def test_speeds_of_discs_of_several_masses_follow_the_mixture():
    """KS of 40 000 at 0.001, and the variance of their sum."""
    radius = np.random.default_rng(1).uniform(0.3, 0.7, 400)
    gas = gas_of((900, 900), np.zeros((400, 2)), 0.0, radius, mass=9 * radius**2)
    ensemble = Ensemble(np.zeros(2), math.inf, 1.0, classes(gas), np.ones((1, 2)))
    velocity = np.random.default_rng(2).normal(size=(2500, 400, 2)) / np.sqrt(gas.mass)[:, None]
    speed, law = np.hypot(*np.moveaxis(velocity, 2, 0)), ensemble.velocity_law("speed", 0)
    assert stats.kstest(speed[:100].ravel(), law.cdf).pvalue > 0.001
    assert ensemble.mean_speed[0] == pytest.approx(speed.mean(), abs=4 * speed.std() / 1000)
    variance = ensemble.variances(np.array([400]))[0, 0]
    assert speed.sum(axis=1).var() == pytest.approx(variance, rel=4 * (2 / 2500) ** 0.5)


@pytest.mark.parametrize("conserved", [(False, False), (True, False), (True, True)])
@pytest.mark.parametrize("quantity", ["vx", "vy", "speed", "energy"])
def test_velocities_are_those_of_points_on_the_energy_surface(conserved, quantity):
    """Momenta at random, without their sum along conserved axes, scaled to the energy; KS of 40 000 at 0.001."""
    mass, dof = np.array([5.0, 1.0, 1.0, 1.0]), 8 - sum(conserved)
    velocity = np.random.default_rng(sum(conserved)).normal(size=(40_000, 4, 2)) / np.sqrt(mass)[:, None]
    velocity -= np.array(conserved) * (mass @ velocity)[:, None] / mass.sum()
    velocity /= np.sqrt((mass @ velocity**2).sum(axis=1) / dof)[:, None, None]  # T = 2E/D = 1
    axes = np.where(conserved, 1 - mass[:2, None] / mass.sum(), 1.0)
    ensemble = Ensemble(np.zeros(2), dof, 1.0, discs_of(mass[:2]), axes)
    for s in range(2):
        x, y = velocity[:, s].T
        sample = {"vx": x, "vy": y, "speed": np.hypot(x, y), "energy": mass[s] * (x**2 + y**2) / 2}[quantity]
        law = ensemble.velocity_law(quantity, s)
        assert stats.kstest(sample, law.cdf).pvalue > 0.001
        assert abs(sample.mean() - law.mean) < 4 * sample.std() / 200
    if quantity == "speed":
        assert ensemble.mean_speed[1] == law.mean


def test_speed_of_a_disc_that_moves_along_one_axis_only():
    """The mean over directions, at its worst: half a normal distribution, whose P(< v) is erf(v/√2)."""
    law = Ensemble(np.zeros(2), math.inf, 1.0, discs_of(np.ones(1)), np.array([[0.0, 1.0]])).velocity_law("speed", 0)
    speed = np.linspace(0, 4, 100)
    assert np.abs(law.cdf(speed) - (2 * stats.norm.cdf(speed) - 1)).max() < 2e-3
    assert law.mean == pytest.approx(math.sqrt(2 / math.pi), rel=1e-4)


@pytest.mark.parametrize("dof", [math.inf, 400.0])
def test_variances_of_speeds_and_energies(dof):
    """Against 4 000 velocities of a heat bath, or of one energy: 4 √(2/4000) and 2/D, by which these vary less."""
    number, mass, rng = np.array([150, 50]), np.array([1.0, 4.0]), np.random.default_rng(3)
    each = np.repeat(mass, number)
    velocity = rng.normal(size=(4000, 200, 2)) * np.sqrt(1.5 / each)[:, None]
    energy = each * (velocity**2).sum(axis=2)
    if math.isfinite(dof):
        scale = 1.5 * dof / energy.sum(axis=1)
        velocity, energy = velocity * np.sqrt(scale)[:, None, None], energy * scale[:, None]
    speed = np.hypot(velocity[:, :, 0], velocity[:, :, 1])
    sums = [np.add.reduceat(values, [0, 150], axis=1).var(axis=0) for values in (speed, energy)]
    variances = Ensemble(np.zeros(2), dof, 1.5, discs_of(mass), np.full((2, 2), 1.5)).variances(number)
    assert variances == pytest.approx(np.array(sums), rel=4 * math.sqrt(2 / 4000) + 2 / 400)
