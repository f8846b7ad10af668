"""A disc and a wall segment, body and ends, beside 50 digits."""

import math
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from helpers.rounding import U, body, exact, gamma

from idealgas.physics.disc_wall import collide_with_wall
from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import NEVER
from idealgas.physics.periodic import NO_IMAGES
from idealgas.physics.wall import (
    accelerated_body_delay,
    end_delay,
    foot_inside,
    misses_segment,
    reflection_changes,
    segment_contact,
    segment_normal,
    straight_body_delay,
    straight_end_delay,
)

pytestmark = [pytest.mark.interpreted, pytest.mark.filterwarnings("ignore:.*encountered")]


def segment(start, end) -> SimpleNamespace:
    (x, y), across = start, np.subtract(end, start)
    length = math.hypot(*across)
    return SimpleNamespace(x=x, y=y, tx=across[0] / length, ty=across[1] / length, length=length, radius=0.0)


def test_straight_flight_to_the_body():
    """A difference and a quotient: two roundings, from either face."""
    draw = np.random.default_rng(1)
    with mpmath.workdps(50):
        for d, s, vn, vt, r in zip(*draw.normal(size=(4, 300)), draw.uniform(0.01, 0.2, 300), strict=True):
            if abs(d) < r:
                continue
            result = straight_body_delay(d, s, vn, vt, r, 2.0)
            expected = (abs(exact(d)) - exact(r)) / abs(exact(vn))
            foot = exact(s) + exact(vt) * expected
            if d * vn > 0 or not 0 < foot < 2:
                assert result == NEVER
            else:
                assert abs(result - expected) <= gamma(2) * expected
    assert straight_body_delay(0.1, 1.0, -1.0, 0.0, 0.2, 2.0) == 0.0  # touches or overlaps, and approaches
    assert straight_body_delay(0.1, 1.0, 1.0, 0.0, 0.2, 2.0) == NEVER
    assert straight_body_delay(1.0, 1.0, 0.0, 1.0, 0.2, 2.0) == NEVER


def test_the_body_is_met_between_its_ends():
    assert [foot_inside(s, 2.0) for s in (-1.0, 0.0, 1e-300, 2.0, 2.5)] == [False, False, True, False, False]
    assert accelerated_body_delay((0.5, 1.0, -1.0, 0.0, 1.0, 0.0), 0.5, 2.0) == 0.0  # touches and comes nearer
    assert accelerated_body_delay((0.5, 1.0, 2.0, 0.0, -1.0, 0.0), 0.5, 2.0) == 4.0  # thrown up from it
    assert accelerated_body_delay((0.5, 1.0, 2.0, 1.0, -1.0, 0.0), 0.5, 2.0) == NEVER  # comes down beside it
    assert accelerated_body_delay((0.25, 1.0, 0.5, 0.0, -1.0, 0.0), 0.5, 2.0) == 1.0  # sunk: back at its depth
    assert accelerated_body_delay((1.5, 1.0, 0.0, 0.0, -2.0, 0.0), 0.5, 2.0) == 1.0  # at rest above it: √(2h/g)
    assert accelerated_body_delay((-1.5, 1.0, 0.0, 0.0, 2.0, 0.0), 0.5, 2.0) == 1.0
    assert accelerated_body_delay((1.0, 1.0, 0.5, 0.0, 1.0, 0.0), 0.5, 2.0) == NEVER


def descents_to_face(d, s, vn, vt, an, at, r, length):
    """Times after 0 at which the exact centre comes down on either face of the body, in order."""
    d, s, vn, vt, an, at, r, length = map(exact, (d, s, vn, vt, an, at, r, length))
    times = []
    for sign in (1, -1):
        h, v, a = sign * d - r, sign * vn, sign * an
        discriminant = v * v - 2 * a * h
        if discriminant > 0:
            root = mpmath.sqrt(discriminant)
            t = (-v - root) / a  # where the velocity v + a t is -root
            if t > 0 and 0 < s + vt * t + at * t * t / 2 < length:
                times.append(t)
    return sorted(times)


def test_a_parabola_to_the_body():
    """The height over the face is zero to 9 roundings of its terms: one of the height and 8 as in a fall."""
    draw = np.random.default_rng(2)
    met = 0
    with mpmath.workdps(50):
        for d, s, vn, vt, an, at in draw.normal(size=(300, 6)) * (1, 1, 1, 1, 2, 1) + np.array((0, 1, 0, 0, 0, 0)):
            r = 0.1
            if abs(d) < 1.01 * r:
                continue
            result = accelerated_body_delay((d, s, vn, vt, an, at), r, 2.0)
            times = descents_to_face(d, s, vn, vt, an, at, r, 2.0)
            if not times:
                assert result == NEVER
                continue
            met += 1
            assert result == pytest.approx(float(times[0]), rel=1e-9)  # of all, the first
            t = exact(result)
            height = abs(exact(d) + exact(vn) * t + exact(an) * t * t / 2) - exact(r)
            terms = abs(exact(d)) + exact(r) + abs(exact(vn) * t) + abs(exact(an) * t * t)
            assert abs(height) <= gamma(9) * terms
    assert met > 60


def distance_to(wall, x, y):
    """From a point to a segment; exact."""
    x, y = x - exact(wall.x), y - exact(wall.y)
    tx, ty, length = map(exact, (wall.tx, wall.ty, wall.length))
    s = min(max(tx * x + ty * y, 0), length)
    return mpmath.sqrt((x - s * tx) ** 2 + (y - s * ty) ** 2)


@pytest.mark.parametrize("gravity", [None, Gravity(0.0, -0.5), Gravity(0.4, 0.3)], ids=["straight", "down", "oblique"])
def test_contact_with_a_segment(gravity):
    """At the time found the disc touches, to 40 roundings of its way (for the body 9, for an end 19 as of the gap,
    turned and shifted by 8, and the sum of the times 2), where it does not graze; and not before.
    """
    draw = np.random.default_rng(5)
    met = missed = 0
    with mpmath.workdps(50):
        for _ in range(120):
            wall = segment(draw.uniform(3, 5, 2), draw.uniform(5.5, 7, 2))
            x, y, vx, vy = *draw.uniform(1, 9, 2), *draw.normal(size=2)
            disc = body(x=x, y=y, vx=vx, vy=vy, r=draw.uniform(0.05, 0.4), m=1.0, t=draw.uniform(0, 1))
            if distance_to(wall, exact(x), exact(y)) < 1.5 * disc.r:
                continue
            result = segment_contact(disc, 0, wall, None, gravity, None, None, NO_IMAGES)
            gx, gy = map(exact, gravity or (0.0, 0.0))

            def place(t, disc=disc, gx=gx, gy=gy):
                return [exact(p) + exact(v) * t + g * t * t / 2
                        for p, v, g in ((disc.x, disc.vx, gx), (disc.y, disc.vy, gy))]  # fmt: skip

            last = exact(result) - exact(disc.t) if result < NEVER else mpmath.mpf(30)
            gaps = [distance_to(wall, *place(last * k / 200)) - exact(disc.r) for k in range(200)]
            assert min(gaps) > 0
            if result == NEVER:
                missed += 1
                continue
            met += 1
            way = sum(abs(exact(p)) + abs(exact(v) * last) + abs(g * last**2)
                      for p, v, g in ((disc.x, disc.vx, gx), (disc.y, disc.vy, gy)))  # fmt: skip
            assert abs(distance_to(wall, *place(last)) - exact(disc.r)) <= gamma(40) * (way + 20) * 20 / exact(disc.r)
    assert met > 15
    assert missed > 15


def test_what_surely_misses_a_segment():
    """No disc that touches it, be it by the last digit of an end; but most of those that do not."""
    draw = np.random.default_rng(9)
    missed = told = 0
    for _ in range(2000):
        wall = segment(draw.uniform(3, 5, 2), draw.uniform(5.5, 7, 2))
        x, y = draw.uniform(1, 9, 2)
        angle = draw.uniform(0, 2 * math.pi)
        disc = body(x=x, y=y, vx=math.cos(angle), vy=math.sin(angle), r=draw.uniform(0.01, 0.4), m=1.0, t=1.0)
        misses = misses_segment(disc, wall, None, None, NO_IMAGES)
        if segment_contact(disc, 0, wall, None, None, None, None, NO_IMAGES) < NEVER:
            assert not misses
        else:
            missed += 1
            told += misses
    assert told > 0.5 * missed > 500
    wall = segment((3.0, 5.0), (5.0, 5.0))
    for y in 5.25 + 1e-16 * np.arange(-50, 50):  # along the wall, whose end it grazes
        disc = body(x=7.0, y=y, vx=-1.0, vy=0.0, r=0.25, m=1.0)
        assert not misses_segment(disc, wall, None, None, NO_IMAGES)
    assert misses_segment(body(x=4.0, y=7.0, vx=0.0, vy=1.0, r=0.5), wall, None, None, NO_IMAGES)
    assert not misses_segment(body(x=4.0, y=7.0, vx=0.0, vy=1.0, r=0.5), wall, Gravity(0.0, -1.0), None, NO_IMAGES)


def test_straight_flight_to_an_end():
    """As of two discs: 4 roundings of the largest length times the condition R/√D, and of the time."""
    draw = np.random.default_rng(6)
    met = 0
    with mpmath.workdps(50):
        for x, y, vx, vy in draw.normal(size=(400, 4)):
            if math.hypot(x, y) < 0.3:
                continue
            result = straight_end_delay(x, y, body(vx=vx, vy=vy, r=0.3), 0.3)
            a, b, p, q, r = map(exact, (x, y, vx, vy, 0.3))
            square, approach = p * p + q * q, a * p + b * q
            D = square * r * r - (p * b - q * a) ** 2
            if D <= 0 or approach >= 0:
                assert result == NEVER or abs(D) < gamma(8) * square * (a * a + b * b)
                continue
            met += 1
            delay, condition = (-approach - mpmath.sqrt(D)) / square, r / mpmath.sqrt(D)
            largest = abs(a) + abs(b) + r
            assert abs(result - delay) <= 4 * U * (largest * condition + delay)
            if x < 0:  # beyond the end of a wall that goes on along x
                assert end_delay(x, y, 0, (y, x, vy, vx, 0.0, 0.0), 9.0, body(vx=vx, vy=vy, r=0.3), 0.3, None) == result
    assert met > 30


def test_an_end_is_met_from_outside_only():
    """Of a disc that a gate closed over: it comes out of reach of the end, and back, before it counts."""
    inside = body(vx=-1.0, vy=0.0, r=0.5)
    assert straight_end_delay(0.4, 0.0, inside, inside.r) == 0.0
    assert end_delay(0.4, 0.0, 0, (0.0, 0.4, 0.0, -1.0, 0.0, 0.0), 2.0, inside, inside.r, None) == NEVER
    back = end_delay(0.4, 0.0, 0, (0.0, 0.4, 0.0, -1.0, 0.0, 0.5), 2.0, inside, inside.r, Gravity(0.5, 0.0))
    assert back == pytest.approx(2 + 2 * math.sqrt(0.1), rel=1e-14)  # 0.4 - t + t²/4 = -0.5, after it has turned


@pytest.mark.parametrize("gravity", [None, Gravity(0.3, -0.7)])
def test_a_fixed_disc_is_met_as_a_disc_that_stays(gravity):
    """A segment of no length, with a radius: at the contact the centres are R + r apart, to the rounding of a place."""
    draw = np.random.default_rng(8)
    fixed = SimpleNamespace(x=0.5, y=-0.25, tx=1.0, ty=0.0, length=0.0, radius=0.8)
    met = 0
    for x, y, vx, vy in draw.normal(size=(300, 4)) * (2, 2, 1, 1):
        disc = body(x=float(x), y=float(y), vx=float(vx), vy=float(vy), r=0.3, t=0.0)
        away = math.hypot(x - fixed.x, y - fixed.y)
        time = segment_contact(disc, 0, fixed, None, gravity, None, None, NO_IMAGES)
        if gravity is None and away > 1.1:
            assert time == straight_end_delay(x - 0.5, y + 0.25, disc, 0.3 + 0.8)
            assert time < NEVER or misses_segment(disc, fixed, None, None, NO_IMAGES)
        if away > 1.1 and time < NEVER:
            met += 1
            g = gravity or Gravity(0.0, 0.0)
            there = SimpleNamespace(x=x + vx * time + g.x * time**2 / 2, y=y + vy * time + g.y * time**2 / 2)
            away = math.hypot(there.x - fixed.x, there.y - fixed.y)
            assert away == pytest.approx(1.1, abs=20 * U * (4 + time * math.hypot(vx, vy) + time**2))
            nx, ny, at_end = segment_normal(there, fixed, None, None, NO_IMAGES)
            assert at_end
            assert (nx, ny) == pytest.approx(((there.x - 0.5) / away, (there.y + 0.25) / away), abs=4 * U)
    assert met > 20


def test_normals():
    """Towards the disc, of unit length to 5 roundings at an end: differences 1, root of squares 3, quotient 1."""
    draw = np.random.default_rng(7)
    wall = segment((2.0, 3.0), (5.0, 7.0))
    along, across = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    for side, nx, ny in ((1, -0.8, 0.6), (-1, 0.8, -0.6)):
        place = np.array([2.0, 3.0]) + 2.0 * along + side * 0.5 * across
        assert segment_normal(body(x=place[0], y=place[1]), wall, None, None, NO_IMAGES) == (nx, ny, False)
    with mpmath.workdps(50):
        for angle in draw.uniform(-1.5, 1.5, 50):  # around the start, seen from beyond it
            away = -along * math.cos(angle) + across * math.sin(angle)
            disc = body(x=2.0 + 0.3 * away[0], y=3.0 + 0.3 * away[1])
            nx, ny, at_end = segment_normal(disc, wall, None, None, NO_IMAGES)
            x, y = exact(disc.x) - 2, exact(disc.y) - 3
            distance = mpmath.sqrt(x * x + y * y)
            assert at_end
            assert abs(nx - x / distance) <= gamma(5) * abs(x / distance)
            assert abs(ny - y / distance) <= gamma(5) * abs(y / distance)
    beyond = segment_normal(body(x=5.6, y=7.8), wall, None, None, NO_IMAGES)
    assert beyond == (pytest.approx(0.6), pytest.approx(0.8), True)


def test_reflection():
    """v - 2(v·n)n/n²: 13 roundings of the speed: of the factor 4 by v·n doubled and 3 of twice the speed, a product of
    twice the speed, and the difference. The speed stays to twice that.
    """
    draw = np.random.default_rng(8)
    with mpmath.workdps(50):
        for angle in draw.uniform(0, 2 * math.pi, 200):
            vx, vy = draw.normal(size=2)
            disc, n = body(vx=vx, vy=vy, m=1.0), (math.cos(angle), math.sin(angle))
            collide_with_wall(disc, 0, *n, 4, None, None, None)
            nx, ny = map(exact, n)
            k = 2 * (exact(vx) * nx + exact(vy) * ny) / (nx**2 + ny**2)
            error = gamma(13) * math.hypot(vx, vy)
            assert abs(disc.vx - (exact(vx) - k * nx)) <= error
            assert abs(disc.vy - (exact(vy) - k * ny)) <= error
            energy = exact(disc.vx) ** 2 + exact(disc.vy) ** 2 - exact(vx) ** 2 - exact(vy) ** 2
            assert abs(energy) <= 4 * error * math.hypot(vx, vy)


def test_what_a_reflection_changes():
    assert reflection_changes(body(vx=1.0, vy=-1e-3), 0, 0.0, 1.0, None)
    assert not reflection_changes(body(vx=1.0, vy=0.0), 0, 0.0, 1.0, None)
    slides = body(x=3.5, y=4.0, vx=1.0, vy=0.0, r=0.5, m=1.0)
    assert segment_contact(slides, 0, segment((3.0, 3.5), (9.0, 3.5)), None, None, None, None, NO_IMAGES) == NEVER
    pressed = segment_contact(
        slides, 0, segment((3.0, 3.5), (9.0, 3.5)), None, Gravity(0.0, -1.0), None, None, NO_IMAGES
    )
    assert pressed == 0.0  # now: gravity takes it to the wall, whatever a reflection changes
    falls = body(x=3.5, y=4.0, vx=1.0, vy=-1e-9, r=0.5, m=1.0, t=7.0)
    assert segment_contact(falls, 0, segment((3.0, 3.5), (9.0, 3.5)), None, None, None, None, NO_IMAGES) == 7.0
