"""Logarithm, sine and cosine with the same bits on every machine; results of C libraries can differ in the last bit.

The functions use only + - * / in double precision, without a fused multiply-add, and their errors are below one unit in
the last place. The polynomials and the order of summation are taken from fdlibm (Sun Microsystems, 1993: e_log.c,
k_sin.c, k_cos.c).
"""

import numpy as np

from idealgas.jit import inline
from idealgas.physics.double_double import multiply, quick_two_sum, root, split, two_product

_LN2_HIGH, _LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
_TWO_PI_HIGH, _TWO_PI_LOW = 6.283185243606567, 6.357301909411278e-08
"""2π as the sum of a float of 26 bits and a small remainder."""

_ROOT_HALF = np.int64(0x3FE6A09E00000000)
"""Bits of the lower end, approximately √½, of the interval to which the mantissa is reduced."""
_EXPONENT = np.int64(52)
_FRACTION = np.int64((1 << 52) - 1)
_THIRD_GUESS = np.int64(0x2A9F7893782DA1CE)
"""Two thirds of the bits of 1. Added to a third of the bits of x, they give the bits of ∛x to within 10 %."""


@inline
def log(x):
    """Natural logarithm of a normal float x > 0."""
    bits = np.float64(x).view(np.int64) + (np.int64(0x3FF0000000000000) - _ROOT_HALF)
    k = np.float64((bits >> _EXPONENT) - np.int64(0x3FF))
    f = np.int64((bits & _FRACTION) + _ROOT_HALF).view(np.float64) - 1.0  # x = 2^k (1 + f), √½ < 1 + f < √2
    s = f / (2.0 + f)
    z = s * s
    w = z * z
    odd = 2.222219843214978396e-01 + w * 1.531383769920937332e-01
    odd = w * (3.999999999940941908e-01 + w * odd)
    even = 1.818357216161805012e-01 + w * 1.479819860511658591e-01
    even = z * (6.666666666666735130e-01 + w * (2.857142874366239149e-01 + w * even))
    half = 0.5 * f * f
    return s * (half + (even + odd)) + k * _LN2_LOW - half + f + k * _LN2_HIGH


@inline
def cos_sin_turns(turns):
    """Cosine and sine of 2π turns, for turns in [0, 1]."""
    quarters = np.int64(4.0 * turns + 0.5)
    remainder = turns - 0.25 * np.float64(quarters)  # exact, at most ⅛
    high, low = split(remainder)
    low = low * _TWO_PI_HIGH + remainder * _TWO_PI_LOW
    x, y = quick_two_sum(high * _TWO_PI_HIGH, low)  # angle and its rounding error
    z = x * x
    w = z * z
    cos, sin = _cos(x, y, z, w), _sin(x, y, z, w)
    swap, sign = np.float64(quarters & 1), np.float64(1 - (quarters & 2))  # exact factors, which also work for arrays
    stay = 1.0 - swap
    return sign * (stay * cos - swap * sin), sign * (stay * sin + swap * cos)


@inline
def _cos(x, y, z, w):
    """Cosine of x + y for |x| <= π/4, where |y| is below the last place of x, z = x² and w = x⁴."""
    r = z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * 2.48015872894767294178e-05))
    more = -2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)
    half = 0.5 * z
    first = 1.0 - half
    return first + (((1.0 - first) - half) + (z * (r + w * w * more) - x * y))


@inline
def _sin(x, y, z, w):
    """Sine of x + y for |x| <= π/4, where |y| is below the last place of x, z = x² and w = x⁴."""
    r = 8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * 2.75573137070700676789e-06)
    r += z * w * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
    cube = z * x
    return x - ((z * (0.5 * y - cube * r) - y) - cube * -1.66666666666666324348e-01)


@inline
def third_power(x):
    """Return x ** (1.0 / 3.0) for a normal float x > 0, for 0 or for infinity.

    The exponent is the float 1.0 / 3.0, which is ⅓ - 2^-54/3.
    """
    if not 0.0 < x < np.inf:
        return x
    y = np.int64(np.float64(x).view(np.int64) // np.int64(3) + _THIRD_GUESS).view(np.float64)
    for _ in range(4):
        y -= (y - x / (y * y)) / 3.0  # Newton's method
    high, low = multiply(two_product(y, y), (y, 0.0))
    return y + (((x - high) - low) / (3.0 * y * y) - y * log(x) * (2.0**-54 / 3.0))


@inline
def quarter_power(x):
    """Return x ** 0.25 for a float x >= 0 or infinity."""
    return root(root((x, 0.0)))[0] if x < np.inf else x
