"""Epoch lengths: powers of two, and a function of the gas alone."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.support import gas_of

from idealgas.effects import piston
from idealgas.effects.bundle import Effects
from idealgas.engine.epoch import (
    EVENTS_PER_DISC,
    MOST_CROSSINGS,
    driving_speed,
    encounters_per_length,
    epoch_length,
    fall_along_sides,
)
from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import MAX_DISPLACEMENT
from idealgas.physics.periodic import Periodic
from idealgas.physics.piston import PISTON

pytestmark = pytest.mark.interpreted


def gas(n=100, speed=1.0, side=50.0):
    draw = np.random.default_rng(3)
    return gas_of((side, side), draw.uniform(1, side - 1, (n, 2)), speed * draw.normal(size=(n, 2)), 0.5)


def length_for(gas):
    return epoch_length(gas, encounters_per_length(gas))


def test_a_power_of_two_that_scales_with_speed_whatever_the_order_of_the_discs():
    for speed in (1e-8, 0.3, 1.0, 1e8):
        assert math.frexp(length_for(gas(speed=speed)))[0] == 0.5
    assert length_for(gas(speed=4.0)) == length_for(gas()) / 4
    assert [length_for(gas(n, speed=0.0)) for n in (1, 100)] == [math.inf, math.inf]
    result = gas()
    for seed in range(20):
        order = np.random.default_rng(seed).permutation(len(result))
        assert length_for(replace(result, velocity=result.velocity[order])) == length_for(result)


def test_close_to_a_power_of_two_the_exact_sum_of_the_speeds_decides():
    """Sums whose rounding depends on the order of the discs would put some of these lengths on the other side."""
    result = gas()
    speeds = np.sqrt(result.velocity[:, 0] ** 2 + result.velocity[:, 1] ** 2)
    events, mean = EVENTS_PER_DISC * len(result), math.fsum(speeds.tolist()) / len(result)
    encounters = events / mean / 2.0**10
    wrong = 0
    for ulps in range(-4, 5):
        close = encounters + ulps * math.ulp(encounters)
        exact = 2.0 ** math.floor(math.log2(events / (mean * close)))
        for seed in range(50):
            order = np.random.default_rng(seed).permutation(len(result))
            assert epoch_length(replace(result, velocity=result.velocity[order]), close) == exact
            rounded = float(speeds[order].sum()) / len(result)
            wrong += 2.0 ** math.floor(math.log2(events / (rounded * close))) != exact
    assert wrong >= 10


@pytest.mark.parametrize("side", [50.0, 300.0])
def test_the_fastest_disc_stays_within_the_largest_displacement(side):
    """Unless the gas is so thin that an epoch would have hardly any events."""
    thin = gas(side=side)
    fastest = np.sqrt((thin.velocity**2).sum(1)).max()
    assert length_for(thin) * fastest <= MAX_DISPLACEMENT * 2 * 0.5


@pytest.mark.parametrize(("n", "fewest"), [(1000, 4000), (100, 512), (10, 512), (1, 512)])
def test_some_events_in_the_thinnest_gas(n, fewest):
    """Four per disc, or some hundred of few discs: an epoch of two events would cost far more than they do."""
    thinnest = gas(n, side=1e9)
    speeds = np.sqrt((thinnest.velocity**2).sum(1))
    events = length_for(thinnest) * speeds.mean() * encounters_per_length(thinnest)
    assert fewest / 2 <= events <= fewest


def test_a_disc_does_not_go_round_the_box_too_often(monkeypatch):
    """A single fast disc among many at rest hardly meets any, but its crossings are counted in 16 bits."""
    n, both = 50_000, (True, True)
    thin = replace(gas(n, speed=0.0), box=(1.0, 1.0), radius=np.full(n, 6e-7))
    thin.velocity[0] = 1.0, 0.0
    encounters = encounters_per_length(thin, both)
    assert MOST_CROSSINGS / 2 <= epoch_length(thin, encounters, periodic=both) <= MOST_CROSSINGS
    monkeypatch.setattr("idealgas.engine.epoch.MOST_CROSSINGS", math.inf)
    assert epoch_length(thin, encounters, periodic=both) > 2**15


def in_a_channel(velocity, periodic=(False, False)):
    """Length of an epoch of one disc with room for a millionth of its diameter across."""
    result = replace(
        gas(1), box=(50.0, 1.0 + 1e-6), position=np.array([[25.0, 0.5 + 5e-7]]), velocity=np.array([velocity])
    )
    return epoch_length(result, encounters_per_length(result, periodic), periodic=periodic)


def test_in_a_narrow_room_only_motion_across_it_counts():
    assert in_a_channel([1.0, 0.0]) > 1e3
    assert in_a_channel([1.0, 1.0]) < 1e-2
    assert in_a_channel([1.0, 1.0], periodic=(False, True)) > 1e2


@pytest.mark.parametrize(("x", "y", "fall"), [(True, False, 3.0), (False, True, 4.0), (True, True, 4.0)])
def test_falls_along_periodic_sides(x, y, fall):
    sides = Periodic(x, y, 50.0, 50.0, np.zeros((100, 2), np.int32))
    assert fall_along_sides(Effects(gravity=Gravity(3.0, -4.0), periodic=sides)) == fall
    assert fall_along_sides(Effects(gravity=Gravity(3.0, -4.0))) == fall_along_sides(Effects(periodic=sides)) == 0.0


def test_what_drives_the_discs():
    """√(5 · 100) by gravity, and the fastest piston; pistons bring M A over the box of 50 by 50."""
    pistons = np.zeros(2, PISTON).view(np.recarray)
    pistons.v, pistons.m, pistons.a = (-2.0, 1.0), (3.0, 4.0), (-0.5, 0.25)
    effects = Effects(gravity=Gravity(3.0, -4.0), piston=pistons)
    assert driving_speed(gas(), effects) == pytest.approx(np.sqrt(500.0) + 2.0, rel=1e-14)
    assert piston.EFFECT.driving_energy(pistons, gas()) == (1.5 + 1.0) * 50
    assert driving_speed(gas(), Effects()) == 0.0
