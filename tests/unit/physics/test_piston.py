"""A piston's way, its meetings with discs and its end stop, and their collisions, beside 50 digits."""

from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from helpers.rounding import body, exact, gamma

from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import NEVER
from idealgas.physics.piston import (
    advance_piston,
    collide_with_piston,
    energy_at_piston,
    is_piston_side,
    misses_piston_until,
    normal_of_piston,
    outward,
    piston_contact,
    piston_energy,
    stop_contact,
)
from idealgas.physics.restitution import Restitution

pytestmark = pytest.mark.interpreted


def some_piston(side=1, **fields) -> SimpleNamespace:
    """At a side of the box, or for side 4 or 5 an inner one that moves along x or y."""
    record = body(**({"x": 8.0, "v": 0.0, "a": 0.0, "m": 3.0, "length": 9.0} | fields))
    record.wall, record.count, record.axis = side, np.uint32(0), side // 2 if side < 4 else side - 4
    record.outward = 0.0 if side >= 4 else 1.0 if side % 2 else -1.0
    return record


def motion(x, v, a, t):
    """Exact place and velocity after a delay, and the sum of the terms of the place."""
    x, v, a = map(exact, (x, v, a))
    return x + v * t + a * t * t / 2, v + a * t, abs(x) + abs(v * t) + abs(a * t * t)


def before_meeting(draw, side, falls):
    """A piston at a side, a disc on the other half of the box, and gravity; without `falls` nothing is accelerated.

    Inner pistons have it on either side.
    """
    sign = draw.choice([-1, 1]) if side >= 4 else 1 if side % 2 else -1
    piston = some_piston(side, x=5 + 2 * sign, v=draw.normal(), a=falls * draw.normal(), t=draw.uniform(0, 0.1))
    x, y = 5 - 2 * sign * draw.uniform(0, 0.5, 2)
    vx, vy = draw.normal(size=2)
    disc = body(x=x, y=y, vx=vx, vy=vy, r=draw.uniform(0.1, 0.5), m=1.0, t=draw.uniform(0, 0.1))
    return piston, disc, Gravity(*draw.normal(size=2)) if falls else None


@pytest.mark.parametrize("side", range(6))
@pytest.mark.parametrize("falls", [True, False])
def test_contact(side, falls):
    """At the time found the exact distance is the radius, to 16 roundings of all terms: 4 for the places at the later
    record, 2 for their difference less the radius, 8 as in a fall, 2 more for what the sum of the times moves.
    """
    draw = np.random.default_rng(side)
    met = 0
    with mpmath.workdps(50):
        for _ in range(150):
            piston, disc, gravity = before_meeting(draw, side, falls)
            result = piston_contact(disc, piston, gravity)
            if result == NEVER:
                continue
            met += 1
            pull = gravity[piston.axis] if gravity else 0.0
            own = (disc.x, disc.vx) if piston.axis == 0 else (disc.y, disc.vy)
            sign = outward(piston, piston.x - own[0])
            assert sign == (1 if piston.x > 5 else -1)
            place, speed, terms = motion(*own, pull, exact(result) - exact(disc.t))
            piston_place, piston_speed, more = motion(piston.x, piston.v, piston.a, exact(result) - exact(piston.t))
            error = gamma(16) * (terms + more + exact(disc.r))
            error += gamma(1) * exact(result) * (abs(speed) + abs(piston_speed))
            distance = sign * (piston_place - place)
            assert result >= max(disc.t, piston.t)
            assert abs(distance - exact(disc.r)) <= error
    assert met > 40


def test_a_disc_that_is_left_behind_never_meets_it():
    assert piston_contact(body(x=5, y=5, vx=1, vy=0, r=0.5, m=1), some_piston(v=1.0), None) == NEVER
    assert piston_contact(body(x=5, y=5, vx=1, vy=0, r=0.5, m=1), some_piston(v=0.5), None) == 5.0
    assert piston_contact(body(x=7.5, y=5, vx=1, vy=0, r=0.5, m=1, t=2), some_piston(), None) == 2.0  # touches


@pytest.mark.parametrize("side", range(6))
@pytest.mark.parametrize("falls", [True, False])
def test_what_surely_misses_it(side, falls):
    """No disc up to the time of its contact; up to a little before, those of which it can tell."""
    draw = np.random.default_rng(side)
    met = told = 0
    for _ in range(300):
        piston, disc, gravity = before_meeting(draw, side, falls)
        result = piston_contact(disc, piston, gravity)
        if result < NEVER:
            met += 1
            assert not misses_piston_until(disc, piston, gravity, result)
            assert not misses_piston_until(disc, piston, gravity, np.nextafter(result, 0))
            told += misses_piston_until(disc, piston, gravity, result * (1 - 1e-8))
        elif not falls:
            assert misses_piston_until(disc, piston, gravity, 0.5 * NEVER)
    assert met > 100
    assert told > (0.3 if falls else 0.99) * met


def test_end_stop_normals_and_sides():
    assert stop_contact(some_piston(v=0.5, t=1.0)) == 3.0
    assert stop_contact(some_piston()) == NEVER
    assert stop_contact(some_piston(x=8.5, a=1.0)) == 1.0
    assert stop_contact(some_piston(side=0, x=2.0, v=-1.0, t=0.5)) == 2.5
    assert stop_contact(some_piston(side=4, v=-0.5)) == 16.0
    assert stop_contact(some_piston(side=5, x=0.0, v=0.5)) == 18.0  # leaves the lower side
    assert (outward(some_piston(3), -1.0), outward(some_piston(2), 1.0)) == (1.0, -1.0)
    assert [outward(some_piston(4), distance) for distance in (0.5, -0.5)] == [1.0, -1.0]
    below, above = (body(x=x, y=x, vx=0, vy=0, r=0.5, m=1.0) for x in (2.0, 9.0))
    assert normal_of_piston(below, some_piston(1)) == (-1.0, 0.0)
    assert normal_of_piston(below, some_piston(4)) == (-1.0, 0.0)
    assert normal_of_piston(above, some_piston(4)) == (1.0, 0.0)
    assert normal_of_piston(above, some_piston(5)) == (0.0, 1.0)
    assert is_piston_side(1, [some_piston()])
    assert not is_piston_side(0, [some_piston()])
    assert not is_piston_side(1, None)
    assert [is_piston_side(side, [some_piston(4), some_piston(1)]) for side in (0, 1)] == [False, True]


def test_motion_and_energy_between_hits():
    """Place and velocity to four roundings a term; so the energy is kept to 16 of its terms: twice for squares, and its
    own.
    """
    draw = np.random.default_rng(5)
    with mpmath.workdps(50):
        for x, v, a, dt, mass in draw.normal(size=(100, 5)) + np.array((5, 0, 0, 4, 3)):
            piston = some_piston(x=x, v=v, a=a, t=1.0, m=abs(mass))
            place, velocity, terms = motion(x, v, a, exact(1.0 + dt) - 1)
            before = piston_energy(piston.m, piston.x, piston.v, piston.a)
            advance_piston(piston, 1.0 + dt)
            assert abs(piston.x - place) <= gamma(4) * terms
            assert abs(piston.v - velocity) <= gamma(3) * (abs(v) + abs(a * dt))
            scale = piston.m * ((abs(v) + abs(a * dt)) ** 2 + abs(a) * terms)
            assert abs(piston_energy(piston.m, piston.x, piston.v, piston.a) - before) <= gamma(16) * scale
            assert piston.t == 1.0 + dt


@pytest.mark.parametrize("side", range(6))
def test_collision_with_a_mass(side):
    """Momentum and energy along the axis are kept, to 8 roundings of a change of at most twice the approach."""
    draw = np.random.default_rng(side)
    with mpmath.workdps(50):
        for _ in range(60):
            (vx, vy, v), (m, mass) = draw.normal(size=3), 10.0 ** draw.uniform(-3, 3, 2)
            disc, piston = body(x=0, y=0, vx=vx, vy=vy, r=0.5, m=m), some_piston(side, v=v, m=mass)
            collide_with_piston(disc, 0, piston, None)
            (old, new), kept = ((vx, disc.vx), disc.vy == vy) if piston.axis == 0 else ((vy, disc.vy), disc.vx == vx)
            scale, m, mass = abs(old) + abs(v), exact(m), exact(mass)
            momentum = m * (exact(new) - exact(old)) + mass * (exact(piston.v) - exact(v))
            assert kept
            assert piston.count == 1
            assert abs(momentum) <= 2 * gamma(8) * scale * (m + mass)
            energy = m * (exact(new) ** 2 - exact(old) ** 2) + mass * (exact(piston.v) ** 2 - exact(v) ** 2)
            assert abs(energy) <= 12 * gamma(8) * scale**2 * (m + mass)  # no speed beyond three times the scale
            assert abs((exact(new) - exact(piston.v)) + (exact(old) - exact(v))) <= 4 * gamma(8) * scale


def test_collision_at_a_given_velocity():
    disc, piston = body(x=0, y=0, vx=1.0, vy=0.5, r=0.5, m=1.0), some_piston(v=-0.25, m=0.0)
    collide_with_piston(disc, 0, piston, None)
    assert (disc.vx, disc.vy, piston.v, piston.count) == (-1.5, 0.5, -0.25, 0)
    collide_with_piston(disc, 0, piston, Restitution(1.0, 0.5, 0.0, np.array([-9.0])))
    assert disc.vx == -1.5 - 1.5 * (-1.5 + 0.25)


@pytest.mark.parametrize(("side", "along"), [(1, -2.0), (3, 3.0), (4, -2.0), (5, 3.0)])
def test_energy_that_an_elastic_hit_would_not_change(side, along):
    """Of a disc of mass 2 at (-2, 3): with a mass 4 at V = 1 more by 2; at a given velocity m (v - V)²/2 along it."""
    disc = body(x=1.0, y=1.0, vx=-2.0, vy=3.0, m=2.0)
    assert energy_at_piston(disc, 13.0, some_piston(side, v=1.0, m=4.0)) == 15.0
    assert energy_at_piston(disc, 13.0, some_piston(side, v=1.0, m=0.0)) == (along - 1) ** 2
