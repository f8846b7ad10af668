"""Exact sums against whole numbers of Python, which have any length."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from idealgas.jit import njit
from idealgas.physics.exact_sum import (
    BATCH,
    FITS,
    SumRangeError,
    add,
    add_all,
    add_sums,
    make_sums,
    restore,
    stored,
    unit_exponent,
    values,
)

TERMS = st.lists(st.floats(-(2.0**99), 2.0**99), max_size=40)


@njit
def add_each(total, terms):
    for term in terms:
        add(total, term)


@njit
def add_in_groups(total, terms, size):
    start = 0
    while start < terms.shape[0]:
        add_all(total, terms[start : start + size])
        start += size


def whole(sums):
    """The sums in their units, from what is stored of them."""
    return [(high << 63) + low for high, low, _ in stored(sums).tolist()]


def summed(terms, typical=2.0**52, way=add_each):
    """A sum, of units 1 unless another size is typical, after all the terms."""
    sums = make_sums([typical])
    way(sums[0], np.array(terms, float))
    return sums


@settings(deadline=None, max_examples=300)
@example([2.0**62, 2.0**62 - 512, -(2.0**62)])
@example([-(2.0**62) - 1024])
@example([0.5, 1.5, -0.5, -2.5])
@example([-1.0] * 3)
@example([2.0**64, 2.0**64 - 2048, -(2.0**64), 2.0**63, -(2.0**63)])
@given(TERMS)
def test_whole_numbers(terms):
    assert whole(summed(terms)) == [sum(map(round, terms))]  # Python rounds ties to even too


@settings(deadline=None, max_examples=100)
@given(TERMS, st.randoms(use_true_random=False), st.integers(1, 9))
def test_any_order_and_any_groups(terms, random, size):
    mixed = random.sample(terms, len(terms))
    sums = summed(terms)
    assert whole(summed(mixed)) == whole(sums)
    assert whole(summed(mixed, way=lambda total, some: add_in_groups(total, some, size))) == whole(sums)


@settings(deadline=None, max_examples=100)
@given(TERMS, TERMS, st.floats(1e-250, 1e250))
def test_stored_and_restored(terms, more, typical):
    sums = summed([term * 2.0 ** unit_exponent(typical) for term in terms], typical)
    again = make_sums([1.0])
    restore(again, stored(sums))
    ((high, low, k),) = stored(sums).tolist()
    assert 0 <= low < 2**63
    assert values(sums)[0] == float(Fraction(high * 2**63 + low) * Fraction(2) ** k)
    for each in (sums, again):
        add_each(each[0], np.array(more) * 2.0**k)
    assert again.tobytes() == sums.tobytes()


def test_units_and_the_error_of_a_term():
    for typical in (1.0, 3e-200, 0.7, 1e250, 2.0**-52):
        unit = 2.0 ** unit_exponent(typical)
        assert 2.0**-53 * typical <= unit <= 2.0**-50 * typical
    assert [unit_exponent(size) for size in (0.0, math.inf)] == [0, 0]
    assert math.isfinite(2.0 ** -unit_exponent(5e-324))
    terms = np.random.default_rng(5).normal(size=10_000)
    exact = sum(map(Fraction, terms.tolist()))
    unit = Fraction(2) ** unit_exponent(1.0)
    (number,) = whole(summed(terms, 1.0))
    assert 0 < abs(number * unit - exact) <= len(terms) * unit / 2


@given(terms=st.lists(st.floats(-FITS, FITS) | st.integers(-(2**53), 2**53).map(lambda n: n / 2), max_size=BATCH))
@settings(max_examples=300)
def test_a_group_is_rounded_as_one_by_one(terms):
    sums = summed(terms, way=lambda total, terms: add_in_groups(total, terms, BATCH))
    assert whole(sums) == [sum(map(round, terms))]


@pytest.mark.parametrize("part", [2.0**31, 2.0**31 - 0.5, 2.0**31 + 0.5, 3 * 2.0**31, 2.0**50 + 2.0**31 - 0.5])
def test_a_group_between_two_upper_parts(part):
    terms = [part, -part, part + 1.0, 0.5 - part, part]
    sums = summed(terms, way=lambda total, terms: add_in_groups(total, terms, BATCH))
    assert whole(sums) == [sum(map(round, terms))]


@pytest.mark.parametrize("term", [FITS - 8, -(FITS - 8), FITS, -FITS, 0.5, 1.5])
def test_the_largest_group(term):
    terms = [term] * BATCH
    sums = summed(terms, way=lambda total, terms: add_in_groups(total, terms, BATCH))
    assert whole(sums) == [sum(map(round, terms))]


@pytest.mark.parametrize("way", [add_each, lambda total, terms: add_in_groups(total, terms, 4)], ids=["add", "add_all"])
@pytest.mark.parametrize("term", [2.0**100, -(2.0**100), 1e300, math.inf, -math.inf, math.nan])
def test_terms_that_are_too_large(term, way):
    assert whole(summed([2.0**100 - 2.0**47, 1.0], way=way)) == [2**100 - 2**47 + 1]
    with pytest.raises(SumRangeError, match="a term of a sum is too large or not a number"):
        summed([1.0, term], way=way)


def test_a_sum_never_wraps():
    for sign in (1, -1):
        sums = make_sums([2.0**52])
        restore(sums, np.array([[sign * 2**62, 5, 0]]))
        add_each(sums[0], np.array([sign * (2.0**100 - 2.0**47)]))
        assert whole(sums) == [sign * (2**125 + 2**100 - 2**47) + 5]
        restore(sums, np.array([[sign * (2**63 - 2), 5, 0]]))
        with pytest.raises(SumRangeError, match="a sum is too large"):
            add_each(sums[0], np.array([sign * 2.0**99]))


@pytest.mark.parametrize("entry", [[[1, 2, 1001]], [[1, 2, -(2**62)]]])
def test_what_is_beyond_all_sums_is_not_restored(entry):
    with pytest.raises(SumRangeError, match="too large"):
        restore(make_sums([1.0]), np.array(entry))


@np.errstate(over="ignore")  # words wrap around, of which Python warns
def test_parts_of_sums_add_up_to_the_bit():
    draw = np.random.default_rng(5)
    terms = draw.normal(size=BATCH) * 10.0 ** draw.integers(-9, 12, BATCH)
    whole, *parts = (make_sums([1.0]) for _ in range(4))
    add_all(whole[0], terms)
    for k in range(3):
        add_all(parts[k][0], terms[k::3])
    total = make_sums([1.0])
    for part in parts:
        add_sums(total, part)
    assert total.tolist() == whole.tolist()
    assert values(total)[0] != 0
