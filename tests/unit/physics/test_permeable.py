"""Walls that let discs pass, beside 50 digits."""

import mpmath
import numpy as np
import pytest
from helpers.rounding import body, exact, gamma

from idealgas.effects.bundle import Effects
from idealgas.effects.wall import make_segments
from idealgas.physics.arc import wall_contact
from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import NEVER
from idealgas.physics.periodic import NO_IMAGES
from idealgas.physics.permeable import FROM_LEFT, FROM_RIGHT, OPEN, closed_face_delay
from idealgas.physics.wall import segment_normal

pytestmark = pytest.mark.interpreted


def descents(d, vn, an, height):
    """Times after 0 at which the exact d + vn t + an t²/2 falls through a height."""
    d, vn, an = map(exact, (d, vn, an))
    if an == 0:
        return [(height - d) / vn] if vn < 0 < (height - d) / vn else []
    root = vn * vn - 2 * an * (d - height)
    times = [(-vn + sign * mpmath.sqrt(root)) / an for sign in (1, -1)] if root > 0 else []
    return [t for t in times if t > 0 and vn + an * t < 0]


@pytest.mark.parametrize("gravity", [0.0, 1.0], ids=["straight", "falling"])
def test_a_disc_bounces_where_it_touches_or_where_its_centre_is_back(gravity):
    """The first time at which the centre comes down to one radius or to the line; 9 roundings of the terms."""
    draw = np.random.default_rng(3)
    met = [0, 0]
    with mpmath.workdps(50):
        for d, vn, an in zip(*draw.normal(size=(3, 600)), strict=True):
            r, an = draw.uniform(0.1, 1.0), gravity * an
            if abs(abs(d) / r - 1) < 0.01:
                continue
            result = closed_face_delay(d, vn, an, r)
            times = {t: h for h in (exact(r), exact(0)) for t in descents(d, vn, an, h)}
            if not times:
                assert result == NEVER
                continue
            t, height = exact(result), times[min(times)]
            met[height > 0] += 1
            there = exact(d) + exact(vn) * t + exact(an) * t * t / 2 - height
            assert abs(there) <= gamma(9) * (abs(exact(d)) + height + abs(exact(vn) * t) + abs(exact(an) * t * t))
            assert t == pytest.approx(float(min(times)), rel=1e-9)
    assert min(met) > 30


def segment(start, end):
    return make_segments(np.array([start]), np.array([end]))[:1]


def contact(wall, passage, gravity=None, **motion):
    """Delay of a disc of radius 0.5, and where it then is with the normal that it meets."""
    disc = body(r=0.5, m=1.0, **motion)
    time = wall_contact(disc, 0, 0, None, passage, NO_IMAGES, Effects(segments=wall, gravity=gravity))
    if time == NEVER:
        return None
    there = body(r=0.5, x=disc.x + disc.vx * time, y=disc.y + disc.vy * time, vx=disc.vx, vy=disc.vy)
    return time, *segment_normal(there, wall[0], passage, None, NO_IMAGES)


def test_faces_ends_and_discs_at_the_face():
    wall = segment((0.0, 0.0), (0.0, 4.0))  # upwards: its left side is that of negative x
    right, left = {"x": 2.5, "y": 2.0, "vx": -1.0, "vy": 0.0}, {"x": -2.5, "y": 2.0, "vx": 1.0, "vy": 0.0}
    assert contact(wall, FROM_LEFT, **right) == (2.0, 1.0, 0.0, False)
    assert contact(wall, FROM_RIGHT, **left) == (2.0, -1.0, 0.0, False)
    for passage, motion in ((FROM_RIGHT, right), (FROM_LEFT, left), (OPEN, left), (OPEN, right)):
        assert contact(wall, passage, **motion) is None
    beside = {"x": 0.2, "y": 2.0, "vx": -1.0, "vy": 0.0}
    assert contact(wall, FROM_LEFT, **beside) == (0.2, 1.0, 0.0, False)  # in the middle, it is hit back
    end = {"x": -0.3, "y": 2.0, "vx": 0.0, "vy": 1.0}
    assert contact(wall, FROM_LEFT, **end) == pytest.approx((1.6, -0.6, -0.8, True))  # over the body, it meets an end
    assert contact(wall, OPEN, **end) is None
    under = {"x": 0.0, "y": -2.5, "vx": 0.0, "vy": 1.0}
    assert contact(wall, FROM_LEFT, **under) == (2.0, 0.0, -1.0, True)
    below = np.nextafter(0.5, 0.0)
    assert closed_face_delay(below, -1.0, 0.0, 0.5) == 0.0
    assert closed_face_delay(below, 1.0, 0.0, 0.5) == NEVER
    assert closed_face_delay(below, 1.0, -2.0, 0.5) == pytest.approx(1.0)
    assert closed_face_delay(-1e-17, -1.0, 0.0, 0.5) == NEVER  # its centre is on the open side
    assert closed_face_delay(0.0, 0.0, 0.0, 0.5) == NEVER


def test_gravity_brings_back_what_has_passed():
    """Thrown up through a line that it passes from below: back at the line, or on the face if it comes clear of it."""
    wall, falls = segment((-9.0, 0.0), (9.0, 0.0)), Gravity(0.0, -1.0)
    low, high = ({"x": 0.0, "y": -0.5, "vx": 0.0, "vy": speed} for speed in (1.25, 2.0))
    assert contact(wall, FROM_RIGHT, falls, **low)[0] == pytest.approx(2.0)  # -0.5 + 1.25 t - t²/2 = 0
    assert contact(wall, FROM_RIGHT, falls, **high)[0] == pytest.approx(2 + 2**0.5)  # … = 0.5
    assert contact(wall, FROM_RIGHT, falls, x=0.0, y=-0.6, vx=0.0, vy=1.0) is None
