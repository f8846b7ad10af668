"""When a disc meets a side of the box, beside 50 digits."""

import mpmath
import numpy as np
import pytest
from helpers.rounding import body, exact, gamma

from idealgas.physics.disc_wall import arrival_delay, inward_normal, reflected_velocity, side_contact
from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import NEVER

pytestmark = [pytest.mark.interpreted, pytest.mark.filterwarnings("ignore:.*encountered")]


def some_disc(draw):
    x, y, vx, vy = *draw.uniform(1, 9, 2), *draw.normal(size=2)
    return body(x=x, y=y, vx=vx, vy=vy, r=draw.uniform(0.01, 1), m=1.0, t=draw.uniform(0, 5))


def test_arrival():
    """A difference and a quotient: two roundings."""
    draw = np.random.default_rng(1)
    with mpmath.workdps(50):
        for position, target, speed in draw.uniform(0.1, 10, (200, 3)):
            velocity = speed if target > position else -speed
            expected = (exact(target) - exact(position)) / exact(velocity)
            result = arrival_delay(np.float64(position), np.float64(velocity), np.float64(target))
            assert abs(result - expected) <= gamma(2) * expected
    assert arrival_delay(np.float64(1.0), np.float64(2.0), np.float64(0.5)) == 0.0  # beyond it by rounding
    assert arrival_delay(np.float64(1.0), np.float64(0.0), np.float64(2.0)) == NEVER


def test_contact_in_straight_flight():
    """Where the centre turns is rounded once, the way to it again, then quotient and sum with the record's time."""
    draw = np.random.default_rng(2)
    with mpmath.workdps(50):
        for _ in range(100):
            disc = some_disc(draw)
            for side in range(4):
                position, velocity = map(exact, ((disc.x, disc.vx), (disc.y, disc.vy))[side // 2])
                target = 10 - exact(disc.r) if side % 2 else exact(disc.r)
                delay = (target - position) / velocity
                result = side_contact(disc, side, 10.0, None)
                if (velocity > 0) != bool(side % 2):
                    assert result == NEVER
                else:
                    error = gamma(1) * target / abs(velocity) + gamma(3) * delay
                    assert abs(result - (exact(disc.t) + delay)) <= error + gamma(1) * (disc.t + delay)


@pytest.mark.parametrize("side", range(4))
def test_contact_under_gravity(side):
    """At the time found the exact parabola is at the side to 11 roundings of its terms: 8 as in a fall, a sum, a target
    and a difference.
    """
    draw = np.random.default_rng(3 + side)
    met = 0
    with mpmath.workdps(50):
        for _ in range(100):
            disc, gravity = some_disc(draw), Gravity(*draw.normal(size=2))
            result = side_contact(disc, side, 10.0, gravity)
            if result == NEVER:
                continue
            met += 1
            x, v, a = map(exact, ((disc.x, disc.vx, gravity.x), (disc.y, disc.vy, gravity.y))[side // 2])
            t = exact(result) - exact(disc.t)
            target = 10 - exact(disc.r) if side % 2 else exact(disc.r)
            moved, slope = abs(v * t) + abs(a * t * t), abs(v) + abs(a * t)
            error = gamma(11) * (abs(x) + target + moved) + gamma(1) * exact(result) * slope
            assert abs(x + v * t + a * t * t / 2 - target) <= error
    assert met > 30


def test_normals_and_what_gravity_across_them_changes():
    draw = np.random.default_rng(4)
    for _ in range(500):
        disc, side = some_disc(draw), draw.integers(4)
        across = Gravity(0.0, -1.0) if side < 2 else Gravity(1.0, 0.0)
        assert side_contact(disc, side, 10.0, across) == side_contact(disc, side, 10.0, None)
    assert [inward_normal(side) for side in range(4)] == [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]


@pytest.mark.parametrize("length", [0.5, 1.0, 2.0])
def test_a_reflection_does_not_depend_on_the_length_of_the_normal(length):
    assert reflected_velocity(body(vx=1.0, vy=-2.0), 0, 0.0, length, None) == (1.0, 2.0)
    assert reflected_velocity(body(vx=1.0, vy=-3.0), 0, length, length, None) == (3.0, -1.0)
