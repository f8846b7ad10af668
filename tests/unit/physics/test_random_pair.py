"""Random numbers, trials and contacts of a gas without positions."""

import math

import numpy as np
import pytest

from idealgas.analysis.theory.hard_discs import collision_rate, mean_relative_speed
from idealgas.engine.records import DISC
from idealgas.physics import random_pair
from idealgas.physics.disc_disc import collide
from idealgas.physics.periodic import NO_IMAGES
from idealgas.physics.random_numbers import GOLDEN, mix, unit_interval

pytestmark = pytest.mark.interpreted


def test_splitmix64_gives_its_published_numbers():
    """For seed 1234567, as printed with the reference implementation (Vigna, https://prng.di.unimi.it/splitmix64.c)."""
    expected = [6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431]
    with np.errstate(over="ignore"):
        found = [int(mix(np.uint64(1234567) + np.uint64(k) * GOLDEN)) for k in range(1, 5)]
    assert found == expected


def test_unit_interval_excludes_zero():
    assert unit_interval(np.uint64(0)) == 2.0**-53
    assert unit_interval(np.uint64(2**64 - 1)) == 1.0


@pytest.mark.parametrize(("n", "radius"), [(1000, 0.02), (50, 0.3)])
def test_trials_accepted_at_equilibrium_speeds_give_the_rate_of_kinetic_theory(n, radius):
    area, mass, temperature, v_ref = 100.0, 2.0, 3.0, 40.0
    phi = n * math.pi * radius**2 / area
    duration = random_pair.mean_trial_time(n, area, phi, 2 * radius, v_ref)
    accepted = mean_relative_speed(temperature, mass) / v_ref
    expected = collision_rate(2 * radius, (n - 1) / area, temperature, mass, phi)
    assert 2 * accepted / duration / n == pytest.approx(expected, rel=1e-13)


def two_discs(a, b, masses=(1.0, 3.0)):
    record = np.zeros(2, DISC).view(np.recarray)
    record.vx, record.vy = np.transpose([a, b])
    record.r, record.m = (0.3, 0.7), masses
    return record


@pytest.mark.parametrize("offset", [-1.0, -0.6, 0.0, 0.25, 0.999])
def test_the_line_of_centres_has_the_sine_of_the_offset(offset):
    record = two_discs((1.0, 2.0), (-0.5, 1.0))
    random_pair.touch_at_random(record[0], record[1], offset)
    centres = np.array([record[0].x - record[1].x, record[0].y - record[1].y])
    relative = np.array([1.5, 1.0])
    unit, ahead = centres / np.hypot(*centres), relative / np.hypot(*relative)
    assert ahead[0] * unit[1] - ahead[1] * unit[0] == pytest.approx(offset, abs=1e-15)
    assert unit @ ahead == pytest.approx(-math.sqrt(1 - offset**2), abs=1e-15)  # a comes from behind b's surface


def test_a_head_on_contact_of_equal_discs_exchanges_the_velocities():
    record = two_discs((2.0, 1.0), (-1.0, 0.5), masses=(1.0, 1.0))
    random_pair.touch_at_random(record[0], record[1], 0.0)
    collide(record[0], record[1], 0, 1, None, None, None, NO_IMAGES)
    assert (record[0].vx, record[0].vy) == pytest.approx((-1.0, 0.5), abs=1e-15)
    assert (record[1].vx, record[1].vy) == pytest.approx((2.0, 1.0), abs=1e-15)
