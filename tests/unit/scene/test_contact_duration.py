"""The default contact duration, and what discs do that have come to rest."""

import math

import pytest
from helpers.support import refused

from idealgas.scene import SceneError, parse_scene

GAS = """
box.size = [10, 8]
restitution = { normal = 0.9, wall = 0.8 }
run.until = 5
species = [{ name = "gas", count = 20, radius = 0.2, speed = 2, region = [0, 0, 8, 8] }]
"""
FALL = "gravity.acceleration=[0, -3]"
PISTON = 'piston=[{ side="right", position=9, mass=4, pressure=0.5 }]'


def scene(*overrides):
    return parse_scene(GAS, overrides=overrides)


def test_without_a_force_it_is_far_below_every_free_time():
    result = scene()
    assert result.pressing_acceleration == (0, 0)
    assert result.restitution.contact_duration == 1e-6 * 20 * 2 * 0.2 / 20 / 2
    assert result.resting_disc is None
    assert scene("piston=[{ position=9, velocity=-0.1 }]").restitution == result.restitution


def test_under_gravity_it_is_a_twentieth_of_the_mean_free_time():
    """`test_defaults` has the mean free time, also under gravity."""
    result = scene(FALL)
    assert result.restitution.contact_duration == pytest.approx(result.mean_free_time / 20, rel=1e-14)
    assert parse_scene(GAS, overrides=[FALL]).restitution == result.restitution


def test_a_force_and_what_is_given():
    result = scene(PISTON)
    assert result.pressing_acceleration == (-0.5 * 8 / 4, 0)
    assert result.restitution.contact_duration == pytest.approx(result.mean_free_time / 20, rel=1e-14)
    assert result.mean_free_time < scene("piston=[{ position=9, velocity=0 }]").mean_free_time
    assert scene(FALL, "restitution.contact_duration=1e-4").restitution.contact_duration == 1e-4
    assert scene(FALL, "restitution={ normal = 1, wall = 1 }").restitution.contact_duration is None
    assert 0 < scene(FALL, "species.gas.speed=0").restitution.contact_duration < math.inf
    with pytest.raises(SceneError, match="no default, because nothing moves at the start"):
        scene("species.gas.speed=0")


def test_rest():
    """Rebounds of speed v < g t/2 are over in less than the contact duration t: m v²/2 = m g h, h < g t²/8."""
    rest = scene(FALL, "restitution.contact_duration=0.01").resting_disc
    assert rest.hits == pytest.approx((100, 125))
    assert rest.height == pytest.approx(3 * 0.01**2 / 8)
    assert rest.energy == pytest.approx(3 * rest.height)
    assert rest.per_free_time == pytest.approx(125 * scene(FALL).mean_free_time)
    assert scene(FALL).resting_disc.per_free_time == pytest.approx(20 / 0.8)
    one_way = scene(FALL, "restitution={ normal=0.5, contact_duration=0.1 }").resting_disc
    assert (one_way.hits, one_way.energy) == (pytest.approx((10, 20)), pytest.approx(9 * 0.1**2 / 8))
    stuck = scene(FALL, "restitution.wall=0").resting_disc
    assert (stuck.hits[1], stuck.per_free_time) == (None, None)


@pytest.mark.parametrize("override", ["box.size=[10]", "gravity.acceleration=3", "piston=3", "species=[]"])
def test_what_is_wrong_elsewhere_is_said_there(override):
    assert "contact_duration" not in str(refused(GAS, FALL, override))
