"""Zeros of polynomials and contacts on parabolas, beside 50 digits."""

import itertools
import math

import mpmath
import numpy as np
import pytest
from helpers.rounding import body, exact, gamma

from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import NEVER
from idealgas.physics.polynomial import cubic, cubic_extrema, first_contact_root, gap, parabola, quadratic_roots

pytestmark = pytest.mark.interpreted


def terms(coefficients, t):
    """Sum of the absolute values of a polynomial's terms; coefficients from the highest power down."""
    return sum(abs(c) * abs(t) ** k for k, c in enumerate(reversed(coefficients)))


def value(coefficients, t):
    """A polynomial at t; coefficients from the highest power down."""
    return sum(c * t**k for k, c in enumerate(reversed(coefficients)))


def zeros_after_0(coefficients, last):
    """Where a polynomial changes sign in (0, last), in order: between its turning points by bisection."""
    if len(coefficients) < 2:
        return []
    degree = len(coefficients) - 1
    turns = zeros_after_0([c * (degree - k) for k, c in enumerate(coefficients[:-1])], last)
    actual = []
    for low, high in itertools.pairwise([mpmath.mpf(0), *turns, last]):
        rises = value(coefficients, low) < 0
        if rises == (value(coefficients, high) > 0):
            for _ in range(140):
                middle = (low + high) / 2
                low, high = (low, middle) if (value(coefficients, middle) > 0) == rises else (middle, high)
            actual.append(high)
    return actual


def wide(draw, n):
    return draw.normal(size=n) * 10.0 ** draw.uniform(-3, 3, n)


def test_cubic_and_parabola():
    """Horner's rule rounds each term at most twice a step: six times in three steps, four in two with ½ a exact."""
    draw = np.random.default_rng(1)
    with mpmath.workdps(50):
        for _ in range(300):
            *coefficients, t = wide(draw, 5)
            result, high = cubic(*coefficients, t), [exact(c) for c in coefficients]
            assert abs(result - value(high, exact(t))) <= gamma(6) * terms(high, exact(t))
            high = [high[2] / 2, high[1], high[0]]
            result = parabola(*coefficients[:3], t)
            assert abs(result - value(high, exact(t))) <= gamma(4) * terms(high, exact(t))


@pytest.mark.parametrize("closeness", [0, 4, 8, 12, 15, 16])
def test_quadratic_roots(closeness):
    """A root is one for c changed by 4 roundings, itself off by 8: what is left of the terms is 16 of them.

    closeness: b² and 4ac agree to so many digits.
    """
    draw = np.random.default_rng(closeness)
    with mpmath.workdps(50):
        for _ in range(200):
            a, b, c = wide(draw, 3)
            if closeness:
                c = b * b / (4 * a) * (1 + draw.choice([-1, 1]) * 10.0**-closeness)
            high = [exact(v) for v in (a, b, c)]
            first, second = quadratic_roots(a, b, c)
            discriminant, doubt = high[1] ** 2 - 4 * high[0] * high[2], gamma(4) * high[1] ** 2
            if first == NEVER:
                assert discriminant < doubt
                continue
            assert discriminant > -doubt
            assert first <= second
            for t in (exact(first), exact(second)):
                assert abs(value(high, t)) <= gamma(16) * terms(high, t)
            if discriminant > 1e6 * doubt:
                true = sorted((-high[1] + s * mpmath.sqrt(discriminant)) / (2 * high[0]) for s in (-1, 1))
                assert abs(first - true[0]) <= 1e-9 * abs(true[0])
                assert abs(second - true[1]) <= 1e-9 * abs(true[1])


def test_quadratics_that_are_none():
    assert quadratic_roots(0.0, 2.0, -3.0) == (1.5, NEVER)
    assert quadratic_roots(0.0, 0.0, 1.0) == (NEVER, NEVER)
    assert quadratic_roots(1.0, 0.0, 1.0) == (NEVER, NEVER)
    assert quadratic_roots(3.0, 0.0, 0.0) == (0.0, 0.0)
    assert quadratic_roots(-1.0, 0.0, 4.0) == (-2.0, 2.0)


def test_turns_of_a_cubic():
    """The computed cubic changes sign within an ulp of a zero: 6 roundings of its terms, and 6 of what an ulp moves it.

    Zeros far enough apart for rounding not to hide them are all found, in order.
    """
    draw = np.random.default_rng(3)
    last = 10.0
    with mpmath.workdps(50):
        for _ in range(200):
            zeros = np.sort(draw.uniform(-5, 15, 3))
            if np.diff([0.0, *zeros, last]).__abs__().min() < 0.01:
                continue
            scale = draw.choice([-1, 1]) * 10.0 ** draw.uniform(-3, 3)
            coefficients = scale * np.poly(zeros)
            result = cubic_extrema(*coefficients, last)
            inside = zeros[(zeros > 0) & (zeros < last)]
            assert list(result[len(inside) :]) == [last] * (3 - len(inside))
            assert result[: len(inside)] == pytest.approx(inside, rel=1e-9)
            high = [exact(c) for c in coefficients]
            for t in map(exact, result[: len(inside)]):
                assert abs(value(high, t)) <= gamma(12) * terms(high, t)


def contact_root(x, y, vx, vy, gx, gy, r, after):
    """The first contact of a disc with this velocity and acceleration."""
    return first_contact_root(x, y, body(vx=vx, vy=vy), Gravity(gx, gy), r, after)


def exact_descents(x, y, vx, vy, gx, gy, r):
    """Times after 0 at which the exact gap falls through zero, in order, and its slope there."""
    x, y, vx, vy, gx, gy, r = map(exact, (x, y, vx, vy, gx, gy, r))
    quartic = [
        (gx**2 + gy**2) / 4, gx * vx + gy * vy, vx**2 + vy**2 + gx * x + gy * y, 2 * (x * vx + y * vy),
        x**2 + y**2 - r**2,
    ]  # fmt: skip
    slope = [c * k for c, k in zip(quartic, (4, 3, 2, 1), strict=False)]
    last = 1 + max(map(abs, quartic)) / abs(quartic[0])  # Cauchy's bound
    times = zeros_after_0(quartic, last)
    return [(t, value(slope, t)) for t in times if value(slope, t) < 0]


def rounding_of_gap(x, y, vx, vy, gx, gy, r, t):
    """Of the two coordinates 4 roundings each, squared 9, their sum 10, less r² 11; an ulp of t moves the gap by 8."""
    along, across = (abs(p) + abs(v * t) + abs(g * t * t / 2) for p, v, g in ((x, vx, gx), (y, vy, gy)))
    return gamma(19) * (along**2 + across**2 + r**2)


@pytest.mark.parametrize("strength", [1e-3, 1.0, 30.0])
def test_first_descent(strength):
    """Off by the rounding of the gap over its slope, twice that for its curvature; the first there is, and the next."""
    draw = np.random.default_rng(int(strength))
    met = 0
    with mpmath.workdps(50):
        for _ in range(60):  # through a point at half the radius, after some time
            r, after, angle = draw.uniform(0.1, 1.4), draw.uniform(0.1, 3), draw.uniform(0, 2 * math.pi)
            (vx, vy), (gx, gy) = draw.normal(size=2), strength * draw.normal(size=2)
            x = 0.5 * r * math.cos(angle) - vx * after - 0.5 * gx * after**2
            y = 0.5 * r * math.sin(angle) - vy * after - 0.5 * gy * after**2
            if math.hypot(x, y) < r:
                continue
            result = contact_root(x, y, vx, vy, gx, gy, r, -1.0)
            met += 1
            for time, slope in exact_descents(x, y, vx, vy, gx, gy, r):
                assert abs(result - time) <= 2 * rounding_of_gap(x, y, vx, vy, gx, gy, r, result) / abs(slope)
                result = contact_root(x, y, vx, vy, gx, gy, r, result)
            assert result == NEVER
    assert met > 30


def test_descents_that_have_begun_or_pass_by():
    assert contact_root(1.0, 0.0, -1.0, 0.0, 0.0, -1.0, 1.0, -1.0) == 0.0  # touches and comes nearer
    assert contact_root(0.5, 0.0, -1.0, 0.0, 0.0, -1.0, 1.0, -1.0) == 0.0  # overlaps and comes nearer
    back = contact_root(0.0, 1.0, 0.0, 3.0, 0.0, -1.0, 1.0, -1.0)  # thrown up from contact: falls back after 2 v/g
    assert back == pytest.approx(6.0, rel=1e-15)
    assert contact_root(5.0, 5.0, 0.0, 0.0, 0.0, 1.0, 1.0, -1.0) == NEVER
    assert contact_root(-3.0, 2.0, 1.0, 0.0, 0.0, 0.125, 1.0, -1.0) == NEVER
    assert exact_descents(-3.0, 2.0, 1.0, 0.0, 0.0, 0.125, 1.0) == []


def test_the_gap_near_contact_keeps_its_digits():
    """From the place, not from expanded terms: a radius of 1e-6 at a distance of 1 after t = 1."""
    with mpmath.workdps(50):
        result = gap(-1.0, 0.0, body(vx=1.0 + 1e-6, vy=0.0), Gravity(0.0, 0.0), 1e-6, 1.0)
        x = exact(-1.0) + exact(1.0 + 1e-6)
        assert abs(result - (x * x - exact(1e-6) ** 2)) <= gamma(3) * 2e-12
    assert math.isfinite(result)
