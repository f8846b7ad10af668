"""Sums that do not depend on the order of their terms, because each term is rounded to a whole number of units 2^k.

The whole numbers, each below 2^100 in size, are added as 128-bit integers, and this addition is associative. The bits
of a sum therefore depend neither on the order or grouping of its terms nor on the number of runs in which they are
added.
"""

import math
from collections.abc import Sequence

import numpy as np

from idealgas.jit import aligned, inline, noinline

SUM = np.dtype(
    [
        ("low", "u8"), ("high", "i8"),  # the sum in units is high * 2^64 + low
        ("per_unit", "f8"),  # factor 2^-k that converts a term to units
    ],
    align=True,
)  # fmt: skip

WORD = 63
"""Number of bits of the lower of the two signed words in which a sum is stored as high * 2^63 + low."""

DIGITS = 52
"""Number of bits of a term of typical size, about the precision of a float."""

FARTHEST = 1000
"""Largest absolute value of the exponent k of a unit, chosen so that both 2^k and 2^-k are floats."""

U = np.uintp
BATCH = 64  # number of terms that are added together
SMALL = 2.0**62  # size below which a term, in units, fits into one word
FITS = SMALL / BATCH  # size below which the sum of BATCH terms fits into one word
LARGEST = 2.0**100  # terms of this size or larger, in units, are refused
FULL = 1 << 61  # largest upper word of a sum that can be stored
HALF = 2.0**32  # terms are rounded in two parts, each a whole number far below 2^51
ROUNDER = 1.5 * 2.0**52  # adding it rounds a number below 2^51; the bits are ROUNDER_BITS plus the integer
ROUNDER_BITS = int(np.float64(ROUNDER).view(np.int64))


class SumRangeError(Exception):
    """A term of a sum is nan or too large, or the sum exceeds its range."""


@inline
def add(total, term):
    """Add a term, rounded to a whole number of units (ties to even), to a SUM.

    Raises:
        SumRangeError: the term is nan or at least 2^100 units, or the sum is too large.
    """
    units = term * total.per_unit
    if abs(units) < SMALL:
        whole = np.int64(round(units))
        add_words(total, whole >> np.int64(63), np.uint64(whole))
    else:
        add_large(total, units)


@inline
def add_words(total, high, low):
    """Add high * 2^64 + low to a SUM; high: i8, low: u8."""
    lower = total.low + low
    total.high += high + np.int64(lower < low)
    total.low = lower


@noinline
def add_large(total, units):
    """Add a whole number of units, at least 2^62 in size, to a SUM.

    Raises:
        SumRangeError: the number is nan or at least 2^100 units, or the sum is too large.
    """
    if not abs(units) < LARGEST:
        raise SumRangeError("a term of a sum is too large or not a number")
    if abs(total.high) > FULL:
        raise SumRangeError("a sum is too large")
    size = abs(units)  # the remainder of a negative number modulo 2^64 may need more digits than a float has
    upper = math.floor(size * 2.0**-64)
    high, low = np.int64(upper), np.uint64(size - upper * 2.0**64)
    if units < 0.0:
        high, low = -high - np.int64(low > 0), np.uint64(0) - low
    add_words(total, high, low)


@noinline
def add_all(total, terms):
    """Add all terms (n,) to a SUM, with the same result as `add` but faster; n is at most BATCH.

    The processor can handle several terms at once. Because few processors can convert several floats to integers at
    once, each float is rounded by adding a constant, and the integer is read from the bits of the result.
    """
    number = np.int64(terms.shape[0])
    upper = number * -ROUNDER_BITS
    lower = upper
    small = np.int64(0)
    per_unit = total.per_unit
    for i in range(number):
        units = terms[U(i)] * per_unit
        high = np.float64(units / HALF + ROUNDER)
        low = np.float64((units - (high - ROUNDER) * HALF) + ROUNDER)
        upper += high.view(np.int64)
        lower += low.view(np.int64)
        small += np.int64(abs(units) < FITS)
    if small == number:
        whole = (upper << np.int64(32)) + lower
        add_words(total, whole >> np.int64(63), np.uint64(whole))
    else:
        for i in range(number):
            add(total, terms[U(i)])


def unit_exponent(typical: float) -> int:
    """Exponent k of the unit 2^k, which is at most 2^-52 of the typical size of a term.

    The exponent is limited to FARTHEST in size; it is 0 if the typical size is 0 or not finite.
    """
    return max(-FARTHEST, min(math.frexp(typical)[1] - 1 - DIGITS, FARTHEST)) if 0 < typical < math.inf else 0


def make_sums(typical: Sequence[float]) -> np.recarray:
    """Return an array (n,) of SUM, all set to 0.

    typical: typical size of the terms of each sum at the start of a run, in the unit of that sum.
    """
    sums = aligned(len(typical), SUM)
    sums.per_unit = [math.ldexp(1.0, -unit_exponent(size)) for size in typical]
    return sums


def values(sums: np.ndarray) -> np.ndarray:
    """Return the sums (n,) f8, rounded to floats, each in its unit."""
    return np.array([math.ldexp(number, k) for number, k in _numbers(sums)])


def add_term(sums: np.ndarray, term: float) -> None:
    """Add a term to the single sum in an array, as `add` does in compiled code."""
    ((number, k),) = _numbers(sums)
    number += round(math.ldexp(term, -k))
    sums["high"], sums["low"] = number >> 64, number & (1 << 64) - 1


def clear(sums: np.ndarray) -> None:
    """Set all sums to 0."""
    sums["low"], sums["high"] = 0, 0


def add_sums(totals: np.ndarray, parts: np.ndarray) -> None:
    """Add a partial sum to each total; both must have the same unit."""
    low = totals["low"] + parts["low"]
    totals["high"] += parts["high"] + (low < totals["low"])
    totals["low"] = low


def stored(sums: np.ndarray) -> np.ndarray:
    """Return the sums in the form in which they are stored, (n, 3) i8.

    A row (high, low, k) stands for the sum (high * 2^63 + low) * 2^k, where 0 <= low < 2^63.
    """
    words = [(number >> WORD, number & (1 << WORD) - 1, k) for number, k in _numbers(sums)]
    return np.array(words, np.int64).reshape(-1, 3)


def restore(sums: np.ndarray, entry: np.ndarray) -> None:
    """Set sums and their units from the result of `stored`.

    Raises:
        SumRangeError: a sum or the exponent of its unit is out of range.
    """
    for total, (high, low, k) in zip(sums, entry.tolist(), strict=True):
        number = (high << WORD) + low
        if abs(number >> 64) > 2 * FULL or abs(k) > FARTHEST:
            raise SumRangeError("a sum is too large, or its unit")
        total["high"], total["low"], total["per_unit"] = number >> 64, number & (1 << 64) - 1, math.ldexp(1.0, -k)


def _numbers(sums: np.ndarray) -> list[tuple[int, int]]:
    """Return each sum as (number, k), which stands for number * 2^k."""
    fields = np.asarray(sums).tolist()  # all at once, because reading a field of a recarray takes microseconds
    return [((high << 64) + low, 1 - math.frexp(per_unit)[1]) for low, high, per_unit in fields]
