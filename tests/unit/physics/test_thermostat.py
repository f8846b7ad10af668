"""Thermostat collisions as a function of random numbers, compared with 50 digits; the distribution of many."""

import math

import mpmath
import numpy as np
import pytest
from helpers.rounding import body, exact, gamma
from scipy import stats

from idealgas.physics.rotation import Rotation
from idealgas.physics.thermal import Thermal
from idealgas.physics.thermal import uniform as uniform_at_wall
from idealgas.physics.thermostat import (
    Thermostat,
    andersen_collision,
    draw_first_collisions,
    end_epoch,
    interval,
    uniform,
)

pytestmark = [pytest.mark.interpreted, pytest.mark.filterwarnings("ignore:overflow encountered")]


def bath(temperature=1.0, rate=1.0, seed=7, discs=4):
    return Thermostat(temperature, rate, np.uint64(seed), np.zeros(discs), np.zeros(discs, np.uint64))


def spins(inertia, discs=4):
    return Rotation(np.zeros(discs), np.full(discs, inertia), 0.0, 0.0)


def test_velocities_spins_and_times():
    """Box and Muller's, and an exponential time.

    Of their length: its two roots 6, products 2, and 14 of the turn, which is off by a product and 2π: 22. The time:
    the logarithm, its quotient and the sum.
    """
    draw = np.random.default_rng(3)
    with mpmath.workdps(50):
        for seed in range(60):
            temperature, rate, mass, inertia, before = 10.0 ** draw.uniform(-3, 3, 5)
            thermostat, rotation = bath(temperature, rate, seed), spins(inertia)
            thermostat.time[2] = before
            u = {k: exact(uniform(thermostat, 2, k)) for k in range(3, 8)}
            disc = body(vx=9.0, vy=9.0, m=mass)
            andersen_collision(disc, 2, thermostat, rotation)
            speed = mpmath.sqrt(-2 * exact(temperature) / exact(mass) * mpmath.log(u[4]))
            spin = mpmath.sqrt(-2 * exact(temperature) / exact(inertia) * mpmath.log(u[6]))
            assert abs(disc.vx - speed * mpmath.cos(2 * mpmath.pi * u[5])) <= gamma(22) * speed
            assert abs(disc.vy - speed * mpmath.sin(2 * mpmath.pi * u[5])) <= gamma(22) * speed
            assert abs(rotation.omega[2] - spin * mpmath.cos(2 * mpmath.pi * u[7])) <= gamma(22) * spin
            assert thermostat.number.tolist() == [0, 0, 1, 0]
            expected = exact(before) - mpmath.log(exact(uniform(thermostat, 2, 3))) / exact(rate)
            assert abs(thermostat.time[2] - expected) <= gamma(3) * expected
            assert not thermostat.time[[0, 1, 3]].any()
            assert not rotation.omega[[0, 1, 3]].any()


def test_first_collisions_are_drawn_as_the_others():
    thermostat = bath(rate=0.25)
    draw_first_collisions(thermostat)
    assert thermostat.time.tolist() == [interval(thermostat, disc_id) for disc_id in range(4)]
    assert not thermostat.number.any()
    disc = body(vx=1.0, vy=2.0, m=1.0)
    andersen_collision(disc, 0, None, None)
    assert (disc.vx, disc.vy) == (1.0, 2.0)


def test_numbers_are_not_those_of_thermal_walls():
    """Neither of the same disc's emissions, nor of each other: the thermostat has other draws of the eight."""
    thermostat, thermal = bath(), Thermal(np.ones(4), np.uint64(7), np.zeros(4, np.uint64))
    result = set()
    for number in range(20):
        thermostat.number[:] = thermal.emissions[:] = number
        result |= {uniform(thermostat, disc_id, draw) for disc_id in range(4) for draw in range(3, 8)}
        result |= {uniform_at_wall(thermal, disc_id, draw) for disc_id in range(4) for draw in range(3)}
    assert len(result) == 20 * 4 * 8


def test_times_keep_their_digits_from_epoch_to_epoch():
    """A power of two is taken away exactly, from 1 to 2⁻⁴⁰ of the time that is left."""
    thermostat = bath()
    thermostat.time[:] = [1 + 2.0**-52, math.pi, 1e3, 1e12]
    before = thermostat.time.copy()
    end_epoch(thermostat, 0.5)
    end_epoch(thermostat, 0.25)
    assert [exact(t) for t in thermostat.time] == [exact(t) - exact(0.75) for t in before]


def test_many_collisions_have_the_laws_of_andersen():
    """Kolmogorov and Smirnov: velocities and spins Gaussian with variance T/m and T/I, times exponential; a seed of
    which a true law fails once in 10⁴ such tests.
    """
    thermostat, rotation, disc = bath(2.0, 0.5, seed=11), spins(0.3), body(vx=0.0, vy=0.0, m=1.5)
    rows = []
    for _ in range(4000):
        before = thermostat.time[1]
        andersen_collision(disc, 1, thermostat, rotation)
        rows.append((disc.vx, disc.vy, rotation.omega[1], thermostat.time[1] - before))
    vx, vy, omega, times = np.array(rows).T
    for values, scale in ((vx, math.sqrt(2 / 1.5)), (vy, math.sqrt(2 / 1.5)), (omega, math.sqrt(2 / 0.3))):
        assert stats.kstest(values, stats.norm(scale=scale).cdf).pvalue > 1e-4
    assert stats.kstest(times, stats.expon(scale=2).cdf).pvalue > 1e-4
    for a, b in ((vx, vy), (vx, omega), (vx[1:], vx[:-1]), (times[1:], times[:-1]), (times, vx)):
        assert abs(stats.pearsonr(a, b).statistic) < 4 / math.sqrt(4000)
