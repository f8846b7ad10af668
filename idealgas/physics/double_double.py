"""Numbers of about 32 digits as pairs (high, low) of floats, where `high` is the float nearest to their sum.

Rounding errors of sums and products are computed with the algorithms of Knuth and Dekker, without a fused multiply-add.
The arithmetic follows Hida, Li & Bailey, Proc. 15th IEEE Symposium on Computer Arithmetic, 155 (2001); relative errors
are a few times 2^-104 = 5e-32.
"""

import math

from idealgas.jit import inline

SPLITTER = 134217729.0  # 2^27 + 1


@inline
def two_sum(a, b):
    """Rounded sum a + b of two floats, and its exact rounding error."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


@inline
def quick_two_sum(a, b):
    """Rounded sum of two floats with |a| >= |b|, and its exact rounding error, with fewer operations than `two_sum`."""
    total = a + b
    return total, b - (total - a)


@inline
def split(a):
    """Two floats of 26 bits each whose sum is exactly a."""
    t = SPLITTER * a
    high = t - (t - a)
    return high, a - high


@inline
def two_product(a, b):
    """Rounded product a * b of two floats, and its exact rounding error."""
    product = a * b
    a_high, a_low = split(a)
    b_high, b_low = split(b)
    return product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low


@inline
def add(a, b):
    """Sum a + b of two pairs."""
    high, low = two_sum(a[0], b[0])
    more, remainder = two_sum(a[1], b[1])
    high, low = quick_two_sum(high, low + more)
    return quick_two_sum(high, low + remainder)


@inline
def subtract(a, b):
    """Difference a - b of two pairs."""
    return add(a, (-b[0], -b[1]))


@inline
def multiply(a, b):
    """Product a * b of two pairs."""
    high, low = two_product(a[0], b[0])
    return quick_two_sum(high, low + (a[0] * b[1] + a[1] * b[0]))


@inline
def divide(a, b):
    """Quotient a / b of two pairs, by long division; b must not be 0."""
    first = a[0] / b[0]
    remainder = subtract(a, multiply(b, (first, 0.0)))
    second = remainder[0] / b[0]
    remainder = subtract(remainder, multiply(b, (second, 0.0)))
    third = remainder[0] / b[0]
    high, low = quick_two_sum(first, second)
    return add((high, low), (third, 0.0))


@inline
def root(a):
    """Square root of a pair a; 0 if a is negative.

    The square root of the high part is improved by one step of Newton's method: Karp & Markstein, ACM TOMS 23, 561
    (1997).
    """
    if a[0] <= 0.0:
        return 0.0, 0.0
    guess = math.sqrt(a[0])
    remainder = subtract(a, two_product(guess, guess))
    return quick_two_sum(guess, remainder[0] / (2.0 * guess))


@inline
def less(a, b):
    """Whether the pair a is less than the pair b."""
    return (a[0] < b[0]) | ((a[0] == b[0]) & (a[1] < b[1]))
