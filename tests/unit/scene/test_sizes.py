"""Radii and masses of a species whose discs differ."""

import math

import numpy as np
import pytest
from helpers.support import logged
from scipy.stats import truncnorm

from idealgas import parse_scene
from idealgas.initial.build import make_gas
from idealgas.scene.scene import describe_gas, gas_digest
from idealgas.toml.dump import dump_document

SCENE = """
[box]
size = [100, 100]
[[species]]
name = "gas"
count = {count}
radius = {radius}
mass = {mass}
temperature = 1.5
[run]
events = 1000
"""
UNIFORM = "{ uniform = [0.3, 0.7] }"
NORMAL = "{ normal = [0.4, 0.1], least = 0.25, most = 0.7 }"


def scene_of(radius, mass="1", count=1000, seed=0):
    return parse_scene(SCENE.format(radius=radius, mass=mass, count=count) + f"[scene]\nseed = {seed}\n")


def gas_of(*args, **options):
    return make_gas(scene_of(*args, **options))


def test_radii_have_mean_and_spread_of_their_distribution():
    radius = gas_of(UNIFORM).radius
    assert radius.mean() == pytest.approx(0.5, rel=1e-14)
    assert radius.std() == pytest.approx(0.4 / math.sqrt(12), rel=1e-6)  # 1 - 1/N² of the variance
    assert 0.3 < radius.min() < radius.max() < 0.7
    radius = gas_of(NORMAL).radius
    law = truncnorm((0.25 - 0.4) / 0.1, (0.7 - 0.4) / 0.1, 0.4, 0.1)
    assert radius.mean() == pytest.approx(law.mean(), rel=1e-5)
    assert radius.std() == pytest.approx(law.std(), rel=1e-3)
    assert np.sort(radius)[[9, 499]] == pytest.approx(law.ppf([9.5e-3, 0.4995]), rel=1e-12)
    assert gas_of("{ values = [0.5, 0.25, 0.125] }", count=5).radius.tolist() == [0.5, 0.25, 0.125, 0.5, 0.25]
    gas = gas_of(UNIFORM, "{ density = 2.0 }")
    assert gas.mass == pytest.approx(2 * math.pi * gas.radius**2, rel=1e-15)
    assert (gas_of(UNIFORM, "3").mass == 3).all()


@pytest.mark.parametrize("mass", ["{ density = 2.0 }", "1"])
def test_velocities_have_the_energy_of_the_temperature_and_no_momentum(mass):
    gas = gas_of(UNIFORM, mass)
    assert gas.kinetic_energy == pytest.approx(1500, rel=1e-13)
    assert np.abs(gas.mass @ gas.velocity).max() < 1e-11
    heavy = gas.radius > 0.5
    part = (gas.mass[:, None] * gas.velocity**2)[heavy].sum() / 2  # mean T, s.d. T/sqrt(n)
    assert part / heavy.sum() == pytest.approx(1.5, abs=4 * 1.5 / math.sqrt(heavy.sum()))


def test_the_gas_is_that_of_every_seed_in_another_order():
    first, second = (scene_of(UNIFORM, seed=seed) for seed in (1, 2))
    assert gas_digest(first) == gas_digest(second)
    a, b = make_gas(first).radius, make_gas(second).radius
    assert (a != b).any()
    assert (np.sort(a) == np.sort(b)).all()
    assert "s.d. 0.231, 0.6 to 1.4 times the mean" in describe_gas(first)


def test_a_log_has_the_radius_and_mass_of_each_disc(tmp_path):
    scene = scene_of(UNIFORM, "{ density = 1.0 }", count=50)
    with logged(scene, tmp_path / "run.h5") as log:
        gas = make_gas(scene)
        assert (log.discs.radius == gas.radius).all()
        assert (log.discs.mass == gas.mass).all()
        assert log.scene == scene


def test_a_scene_survives_writing_and_reading():
    for radius in (UNIFORM, NORMAL, "{ normal = [0.4, 0.1] }", "{ values = [0.5, 0.25] }"):
        scene = scene_of(radius, "{ density = 2.0 }")
        assert parse_scene(dump_document(scene)) == scene


@pytest.mark.parametrize("placement", ["random", "lattice", "compressed"])
def test_placed_discs_do_not_overlap(placement):
    text = SCENE.format(radius=UNIFORM, mass=1, count=900).replace("[100, 100]", "[45, 45]")
    sides = "".join(f"{side} = 'periodic'\n" for side in ("left", "right", "bottom", "top"))
    gas = make_gas(parse_scene(text.replace("[[species]]", f"{sides}[[species]]\nplacement = '{placement}'", 1)))
    apart = gas.position[:, None] - gas.position
    apart -= 45 * np.round(apart / 45)
    reach = gas.radius[:, None] + gas.radius
    assert (np.hypot(*np.moveaxis(apart, 2, 0)) >= reach)[~np.eye(900, dtype=bool)].all()
