"""When a body under constant acceleration comes down on a plane, beside 50 digits."""

import math

import mpmath
import numpy as np
import pytest
from helpers.rounding import exact, gamma

from idealgas.physics.motion import NEVER, stays_above, time_to_plane

pytestmark = pytest.mark.interpreted


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
            found = time_to_plane(height, velocity, pull)
            h, v, a = map(exact, (height, velocity, pull))
            if found == NEVER:
                assert v * v - 2 * a * h < gamma(4) * v * v
                continue
            met += 1
            t = exact(found)
            terms = abs(h) + abs(v * t) + abs(a * t * t / 2)
            assert abs(h + v * t + a * t * t / 2) <= gamma(8) * terms
    assert met > 100


def test_what_touches_and_falls_is_there_now():
    assert time_to_plane(0.0, -1.0, 5.0) == 0.0
    assert time_to_plane(-1e-17, -1e-9, -1.0) == 0.0


def test_what_rises_or_rests_without_a_pull_never_comes():
    assert time_to_plane(1.0, 1.0, 0.0) == NEVER
    assert time_to_plane(1.0, 0.0, 0.0) == NEVER
    assert time_to_plane(-1.0, 2.0, 1.0) == NEVER
    assert time_to_plane(1.0, -1.0, 0.500001) == NEVER  # turns before it is there


def test_what_rounding_put_below_comes_back_or_turns():
    assert time_to_plane(-1.5, 2.0, -1.0) == 3.0  # rises through zero at 1, falls through it at 3
    assert time_to_plane(-5.0, 2.0, -1.0) == 2.0  # turns at 2, below zero


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
