"""Free flight beside 50 digits, for discs and for arrays."""

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
        (1.0, 0.0, 0.0, NEVER),
        (1.0, 2.0, 0.0, NEVER),
    ],
)
def test_falls_to_a_plane(height, velocity, acceleration, delay):
    assert time_to_plane(height, velocity, acceleration) == pytest.approx(delay, rel=1e-15)


def test_what_stays_above_a_plane_at_both_ends_of_a_flight():
    assert stays_above(1.0, 0.0, -2.0, 0.99)
    assert not stays_above(1.0, 0.0, -2.0, 1.01)
    assert not stays_above(0.0, 1.0, 0.0, 1.0)
    assert not stays_above(9.0, 0.0, 0.1, 1.0)  # it may have been below


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
