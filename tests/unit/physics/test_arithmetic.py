"""Pairs of floats as numbers, compiled and in plain Python; their digits: see `test_double_double`."""

import math

import numpy as np
import pytest

from idealgas.jit import njit
from idealgas.physics import double_double
from idealgas.physics.arithmetic import Pair, changed, correction, load, number, parts, root, rounded, store

pytestmark = pytest.mark.interpreted


@njit
def combine(columns, results, order):
    """All operators on numbers 0 and 1 of a column, and comparisons of them."""
    a, b = load(columns, 0), load(columns, 1)
    for k, value in enumerate((a + b, a - b, a * b, a / b, root(a * a), max(a, b), number(0.25, a))):
        store(results, k, value)
    order[0] = a < b
    order[1] = a > b
    order[2] = a <= b
    order[3] = a == b
    order[4] = a == a
    return rounded(a * b)


def combined(columns):
    result, order = np.zeros((7, *columns.shape[1:]), columns.dtype), np.zeros(5, np.bool_)
    product = combine(columns, result, order)
    return result, order.tolist(), product


@pytest.mark.parametrize(
    "pair", [((2.0, 1e-17), (-3.0, 2e-17)), ((-1.5, 0.0), (0.1, -1e-18)), ((4.0, 1e-17), (4.0, 3e-17))]
)
def test_pairs_have_the_operators_of_numbers(pair):
    result, order, product = combined(np.array(pair))
    a, b = pair
    sums = [getattr(double_double, name)(a, b) for name in ("add", "subtract", "multiply", "divide")]
    square = double_double.root(double_double.multiply(a, a))
    assert [tuple(row) for row in result.tolist()] == [*sums, square, max(a, b), (0.25, 0.0)]
    assert order == [a < b, a > b, a <= b, a == b, True]
    assert product == sums[2][0]


@pytest.mark.parametrize("dtype", ["f4", "f8"])
def test_floats_of_every_length_keep_it(dtype):
    a, b = values = np.array([0.7, -1.3], dtype)
    result, order, product = combined(values)
    expected = [a + b, a - b, a * b, a / b, np.sqrt(a * a), max(a, b), 0.25]
    assert result.tolist() == np.array(expected, dtype).tolist()
    assert order == [False, True, False, False, True]
    assert product == a * b


@pytest.mark.parametrize(
    ("excess", "work", "change"),
    [(1e-13, 4.0, -2.5e-14), (-1e-13, 4.0, 2.5e-14), (5e-12, 4.0, 0.0), (-5e-12, 4.0, 0.0)],
)
def test_an_excess_of_energy_by_rounding_is_taken_back(excess, work, change):
    """Less impulse for an excess; what is above 10⁻¹² of the work is not due to rounding."""
    assert correction(excess, work) == change


def test_a_corrected_change_is_rounded_once_and_plain_python_has_the_same_numbers():
    assert changed(1.0, 2.0**-53, 0.0) == 1.0
    assert changed(1.0, 2.0**-53, 0.5) == 1.0 + 2.0**-52
    assert parts(changed(Pair(1.0, 0.0), Pair(0.5, 0.0), Pair(0.25, 0.0))) == (1.625, 0.0)
    a, b = Pair(2.0, 1e-17), Pair(-3.0, 2e-17)
    assert parts(a + b) == double_double.add((2.0, 1e-17), (-3.0, 2e-17))
    assert a != b
    assert a == Pair(2.0, 1e-17)
    assert not a <= b < a > b == a
    assert root(np.float32(2.0)) == np.float32(math.sqrt(2.0))
    assert type(root(np.float32(2.0))) is type(number(0.0, np.float32(1.0))) is np.float32
    assert (number(0.5, 1.0), parts(number(0.5, a)), rounded(a)) == (0.5, (0.5, 0.0), 2.0)
