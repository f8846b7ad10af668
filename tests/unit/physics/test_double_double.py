"""Double-double arithmetic beside mpmath, and its exact parts beside fractions."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from idealgas.physics import double_double

ULP = 2.0**-104
"""Relative: Hida, Li & Bailey (2001); Joldes, Muller & Popescu, ACM TOMS 44, 15 (2017) have sharper bounds."""

pytestmark = pytest.mark.interpreted


def numbers(n, seed, sign=True):
    """Pairs whose low part is anything below half an ulp of the high one."""
    random = np.random.default_rng(seed)
    high = random.uniform(0.5, 1, n) * 10.0 ** random.uniform(-8, 8, n)
    if sign:
        high *= random.choice([-1, 1], n)
    low = np.spacing(high) * random.uniform(-0.5, 0.5, n)
    return [double_double.quick_two_sum(float(h), float(l)) for h, l in zip(high, low, strict=True)]


def exact(a):
    return Fraction(a[0]) + Fraction(a[1])


@pytest.mark.parametrize("seed", range(3))
def test_sums_and_products_of_floats_lose_nothing(seed):
    for (a, _), (b, _) in zip(numbers(300, seed), numbers(300, seed + 10), strict=True):
        assert exact(double_double.two_sum(a, b)) == Fraction(a) + Fraction(b)
        assert exact(double_double.two_product(a, b)) == Fraction(a) * Fraction(b)


@pytest.mark.parametrize("name", ["add", "subtract", "multiply", "divide"])
def test_arithmetic_keeps_32_digits(name):
    operation = {"add": "__add__", "subtract": "__sub__", "multiply": "__mul__", "divide": "__truediv__"}[name]
    for a, b in zip(numbers(1000, 1), numbers(1000, 2), strict=True):
        result = getattr(double_double, name)(a, b)
        true = getattr(exact(a), operation)(exact(b))
        assert abs(exact(result) - true) <= 10 * ULP * abs(true)
        assert result[0] == result[0] + result[1]


def test_what_nearly_cancels_keeps_its_digits():
    for a in numbers(300, 5):
        b = double_double.multiply(a, (1.0, 2.0**-60))
        assert abs(exact(double_double.subtract(a, b)) - (exact(a) - exact(b))) <= 4 * ULP * abs(exact(a) - exact(b))


def test_roots_keep_32_digits_and_the_low_part_decides_the_order():
    with mpmath.workdps(60):
        for a in numbers(1000, 3, sign=False):
            true = mpmath.sqrt(mpmath.mpf(a[0]) + mpmath.mpf(a[1]))
            high, low = double_double.root(a)
            assert abs(mpmath.mpf(high) + mpmath.mpf(low) - true) <= 10 * ULP * true
    assert double_double.root((0.0, 0.0)) == (0.0, 0.0)
    assert double_double.less((1.0, -1e-20), (1.0, 1e-20))
    assert not double_double.less((1.0, 1e-20), (1.0, 1e-20))
    assert double_double.less((-1.0, 0.0), (1.0, -1e-20))
