"""Free flight, and when a body under constant acceleration comes down on a plane, beside 50 digits."""

import math

import mpmath
import numpy as np
import pytest
from helpers.rounding import body, exact, gamma

from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import (
    NEVER,
    advance,
    path_length,
    position_after,
    stays_above,
    time_after,
    time_to_plane,
    velocity_after,
)

pytestmark = pytest.mark.interpreted


def some(seed, n=300):
    """Positions, velocities, accelerations and delays over six decades."""
    draw = np.random.default_rng(seed)
    return draw.normal(size=(4, n)) * 10.0 ** draw.uniform(-3, 3, (4, n))


def test_position_and_velocity():
    """Each term goes through at most three roundings: x two sums; v t a product and two sums; ½ a t² two and a sum."""
    with mpmath.workdps(50):
        for values in some(1).T:
            x, v, a, t = map(exact, values)
            terms = abs(x) + abs(v * t) + abs(a * t * t / 2)
            assert abs(position_after(*values) - (x + v * t + a * t * t / 2)) <= gamma(3) * terms
            assert abs(position_after(*values[:2], None, values[3]) - (x + v * t)) <= gamma(2) * (abs(x) + abs(v * t))
            assert abs(velocity_after(*values[1:]) - (v + a * t)) <= gamma(2) * (abs(v) + abs(a * t))


def test_arrays_and_numbers_give_the_same_bits():
    x, v, a, t = some(2)
    assert position_after(x, v, a, t).tolist() == [position_after(*values) for values in zip(x, v, a, t, strict=True)]
    straight = [position_after(p, q, None, s) for p, q, s in zip(x, v, t, strict=True)]
    assert position_after(x, v, None, t).tolist() == straight
    assert velocity_after(v, a, t).tolist() == [velocity_after(*values) for values in zip(v, a, t, strict=True)]


@pytest.mark.parametrize(("now", "delay", "time"), [(3.0, 0.5, 3.5), (3.0, 0.0, 3.0), (3.0, 1e-20, 3.0 + 2.0**-51)])
def test_a_delay_always_takes_time(now, delay, time):
    assert time_after(now, delay) == time


@pytest.mark.parametrize("gravity", [None, Gravity(0.3, -1.7)])
def test_a_disc_flies_along_both_axes(gravity):
    disc = body(x=1.5, y=2.5, vx=-0.7, vy=0.9, t=3.0)
    advance(disc, 5.25, gravity)
    pull = gravity or (None, None)
    expected = [position_after(x, v, a, 2.25) for x, v, a in ((1.5, -0.7, pull[0]), (2.5, 0.9, pull[1]))]
    assert (disc.x, disc.y, disc.t) == (*expected, 5.25)
    speeds = (-0.7, 0.9) if gravity is None else (velocity_after(-0.7, 0.3, 2.25), velocity_after(0.9, -1.7, 2.25))
    assert (disc.vx, disc.vy) == speeds


@pytest.mark.parametrize(
    ("height", "velocity", "acceleration", "delay"),
    [
        (1.0, 0.0, -2.0, 1.0),  # at rest: √(2h/g)
        (1.5, 1.0, -4.0, 1.1513878188659974),  # thrown up: (1 + √13)/4
        (1.5, -1.0, -4.0, 0.6513878188659974),
        (4.0, -2.0, 0.0, 2.0),
        (4.0, -2.0, 0.5, 4.0),  # turns just as it touches
        (4.0, -2.0, 0.6, NEVER),  # turns before
        (0.0, -1.0, 3.0, 0.0),
        (-0.5, -1.0, 3.0, 0.0),
        (-0.5, 2.0, -1.0, 3.7320508075688773),  # rises out: 2 + √3
        (-4.0, 2.0, -1.0, 2.0),  # never rises so far: when it begins to fall
        (-1.5, 2.0, -1.0, 3.0),  # rises through zero at 1, falls through it at 3
        (-1e-17, -1e-9, -1.0, 0.0),
        (-1.0, 2.0, 1.0, NEVER),
        (1.0, -1.0, 0.500001, NEVER),
        (1.0, 0.0, 0.0, NEVER),
        (1.0, 2.0, 0.0, NEVER),
    ],
)
def test_falls_to_a_plane(height, velocity, acceleration, delay):
    assert time_to_plane(height, velocity, acceleration) == pytest.approx(delay, rel=1e-15)


def test_length_of_a_path():
    """Of parabolas, also straight up and down, and of straight lines, whether gravity is zero or absent."""
    velocity, gravity = some(3, 600)[:4].reshape(2, 2, 600)
    delay = np.abs(some(4, 600)[3])
    gravity[:, ::7], velocity[:, ::11] = 0.0, 0.0
    velocity[:, ::5] = gravity[:, ::5] * some(5, 120)[0]
    lengths = path_length(*velocity, gravity, delay)
    assert path_length(*velocity, (0.0, 0.0), delay) == pytest.approx(path_length(*velocity, None, delay), rel=1e-15)
    with mpmath.workdps(60):
        for k, length in enumerate(lengths):
            (vx, vy), (gx, gy), t = map(exact, velocity[:, k]), map(exact, gravity[:, k]), exact(delay[k])
            g, right = mpmath.hypot(gx, gy), mpmath.hypot(vx, vy) * t
            if g:
                first, across = (vx * gx + vy * gy) / g, abs(vx * gy - vy * gx) / g
                arc = lambda u, w: u * mpmath.hypot(u, w) + (w * w * mpmath.asinh(u / w) if w else 0)  # noqa: E731
                right = (arc(first + g * t, across) - arc(first, across)) / (2 * g)
            assert abs(length - right) <= 8 * 2.0**-53 * right


def exact_fall(height, velocity, acceleration):
    """First time at which the exact parabola is at zero and falls; None if it never is. For a height above zero."""
    h, v, a = map(exact, (height, velocity, acceleration))
    discriminant = v * v - 2 * a * h
    if discriminant < 0 or (v >= 0 and a >= 0):
        return None
    root = mpmath.sqrt(discriminant)
    return 2 * h / (root - v) if v < 0 else (v + root) / -a


def test_free_fall():
    """With v a falls without cancellation: D has two roundings a term, its root 2, the sum 3 and the quotient 4."""
    draw = np.random.default_rng(1)
    with mpmath.workdps(50):
        for _ in range(300):
            height, speed, pull = 10.0 ** draw.uniform(-6, 6, 3)
            velocity = speed * draw.choice([-1.0, 1.0])
            expected = exact_fall(height, velocity, -pull)
            assert abs(time_to_plane(height, velocity, -pull) - expected) <= gamma(4) * expected


def test_a_fall_that_is_slowed_down():
    """D may cancel. The time is the exact one to 4 roundings for a height changed by 4, so the body is there to 8."""
    draw = np.random.default_rng(2)
    met = 0
    with mpmath.workdps(50):
        for _ in range(300):
            height, pull = 10.0 ** draw.uniform(-3, 3, 2)
            velocity = -math.sqrt(2 * pull * height) * (1 + draw.choice([-1, 1]) * 10.0 ** draw.uniform(-16, 0))
            result = time_to_plane(height, velocity, pull)
            h, v, a = map(exact, (height, velocity, pull))
            if result == NEVER:
                assert v * v - 2 * a * h < gamma(4) * v * v
                continue
            met += 1
            t = exact(result)
            terms = abs(h) + abs(v * t) + abs(a * t * t / 2)
            assert abs(h + v * t + a * t * t / 2) <= gamma(8) * terms
    assert met > 100


def test_what_stays_above():
    """Until the body is down, to 1e-14 of that time; one that is pulled up is never said to stay above."""
    draw = np.random.default_rng(3)
    for _ in range(300):
        height, speed, pull = 10.0 ** draw.uniform(-6, 6, 3)
        velocity = speed * draw.choice([-1.0, 1.0])
        fall = time_to_plane(height, velocity, -pull)
        assert stays_above(height, velocity, -pull, fall * (1 - 1e-14))
        assert not stays_above(height, velocity, -pull, fall * (1 + 1e-14))
        assert not stays_above(-height, velocity, -pull, 0.1 * fall)
        assert not stays_above(height, speed, pull, fall)
    assert stays_above(1.0, 1.0, 0.0, NEVER)
    assert not stays_above(1.0, -1.0, -1.0, NEVER)
    assert stays_above(1.0, 0.0, -2.0, 0.99)
    assert not stays_above(1.0, 0.0, -2.0, 1.01)
    assert not stays_above(0.0, 1.0, 0.0, 1.0)
    assert not stays_above(9.0, 0.0, 0.1, 1.0)  # it may have been below
