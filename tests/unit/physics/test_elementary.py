"""Logarithm, sine and cosine, and two powers, beside `mpmath`; compiled code gives the same bits as Python."""

import math

import mpmath
import numpy as np
import pytest

from idealgas.jit import njit
from idealgas.physics.elementary import cos_sin_turns, log, quarter_power, third_power

FEW, MANY = 10**4, 10**6


def random_numbers(number):
    """In (0, 1] as `unit_interval` makes them: half of them uniform, half of all orders of magnitude down to 2^-53."""
    random = np.random.default_rng(number)
    whole = random.integers(1, 2**53, number, endpoint=True)
    whole[::2] >>= random.integers(0, 53, len(whole[::2]))
    return [*(np.maximum(whole, 1) * 2.0**-53).tolist(), 2.0**-53, 1.0]


def units(result, expected):
    """Distance of a float from an exact number in units in its last place; 0 where both are 0."""
    return float(abs(mpmath.mpf(float(result)) - expected) / math.ulp(float(expected))) if expected else abs(result)


@pytest.mark.interpreted
def test_logarithm_is_within_one_unit_in_the_last_place():
    """So fdlibm's comment on e_log.c has it: "the error is always less than 1 ulp"."""
    with mpmath.workprec(90):
        numbers = random_numbers(FEW)
        assert max(units(log(x), mpmath.log(x)) for x in numbers) < 1
        assert max(units(log(x), mpmath.log(x)) for x in (np.exp(700 * np.array(numbers[:1000]) - 350)).tolist()) < 1


@pytest.mark.interpreted
def test_cosine_and_sine_are_within_one_unit_in_the_last_place_and_quarter_turns_exact():
    with mpmath.workprec(120):
        worst = [0.0, 0.0]
        for turns in random_numbers(FEW):
            exact = mpmath.cospi(2 * mpmath.mpf(turns)), mpmath.sinpi(2 * mpmath.mpf(turns))
            worst = [max(pair) for pair in zip(worst, map(units, cos_sin_turns(turns), exact), strict=True)]
        assert max(worst) < 1
    actual = [tuple(map(float, cos_sin_turns(quarters / 4))) for quarters in range(5)]
    assert actual == [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 0)]


@pytest.mark.interpreted
def test_powers_are_within_one_unit_in_the_last_place():
    with mpmath.workprec(120):
        for x in np.exp(np.random.default_rng(3).uniform(-600, 600, 10**4)).tolist():
            assert units(third_power(x), mpmath.mpf(x) ** mpmath.mpf(1 / 3)) < 0.51
            assert units(quarter_power(x), mpmath.root(x, 4)) < 0.51
    assert [f(x) for f in (third_power, quarter_power) for x in (0.0, np.inf)] == [0, np.inf, 0, np.inf]


@njit
def all_of(numbers, values):
    """Every function of every number."""
    for i in range(numbers.shape[0]):
        values[i, 0], values[i, 1] = cos_sin_turns(numbers[i])
        values[i, 2], values[i, 3], values[i, 4] = log(numbers[i]), third_power(numbers[i]), quarter_power(numbers[i])


def test_compiled_code_gives_the_same_bits():
    """No operation is fused with another or put in another order."""
    numbers = np.array(random_numbers(FEW))
    result, python = np.empty((len(numbers), 5)), np.empty((len(numbers), 5))
    all_of(numbers, result)
    getattr(all_of, "py_func", all_of)(numbers, python)
    assert result.tobytes() == python.tobytes()


def extended(numbers):
    """Cosine, sine and logarithm (3, n); their errors are below 2^-9 units in the last place of a float."""
    x = numbers.astype(np.longdouble)
    quarters = np.rint(4 * x)
    angle = 2 * np.longdouble("3.14159265358979323846264338327950288") * (x - quarters / 4)
    c, s = np.cos(angle), np.sin(angle)
    which = quarters.astype(int) % 4
    turned = np.choose(which, [c, -s, -c, s]), np.choose(which, [s, c, -s, -c])
    return np.array([*turned, np.log(x)])


@pytest.mark.needs("extended precision")
def test_a_million_arguments():
    """Within one unit in the last place, less the error of the reference, which is compared with `mpmath`."""
    numbers = np.array(random_numbers(MANY))
    result, expected = np.empty((len(numbers), 5)), extended(numbers)
    all_of(numbers, result)
    assert (np.abs(result[:, :3].T - expected) / np.spacing(np.abs(expected).astype(float))).max() < 1 - 2.0**-9
    with mpmath.workprec(120):
        for k in range(0, MANY, 1000):
            x = mpmath.mpf(numbers[k])
            for known, value in zip(
                (mpmath.cospi(2 * x), mpmath.sinpi(2 * x), mpmath.log(x)), expected[:, k], strict=True
            ):
                high = float(value)
                assert abs(high - known + mpmath.mpf(float(value - np.longdouble(high)))) < 2.0**-9 * math.ulp(high)
