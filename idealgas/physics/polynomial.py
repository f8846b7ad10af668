"""First time at which a body on a parabola comes within a distance of a point, where a quartic falls through zero."""

import math

from idealgas.jit import inline, noinline
from idealgas.physics.elementary import quarter_power, third_power
from idealgas.physics.motion import NEVER

BISECTIONS = 200  # enough to halve any interval down to neighbouring floats


@inline
def cubic(b, c, d, e, t):
    """Value of b t³ + c t² + d t + e."""
    return ((b * t + c) * t + d) * t + e


@inline
def parabola(x, v, a, t):
    """Value of x + v t + ½ a t²; the form x + (v + ½ a t) t keeps more digits near a return to x."""
    return x + (v + 0.5 * a * t) * t


@inline
def bisect(b, c, d, e, low, high):
    """Point in [low, high] where a cubic changes sign, to the last bit; its signs at the ends must differ."""
    rising = cubic(b, c, d, e, low) < cubic(b, c, d, e, high)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            break
        if (cubic(b, c, d, e, middle) > 0.0) == rising:
            high = middle
        else:
            low = middle
    return high if not rising else low


@inline
def quadratic_roots(a, b, c):
    """Real roots of a t² + b t + c in increasing order, without cancellation; NEVER stands for a missing root."""
    if a == 0.0:
        return (-c / b, NEVER) if b != 0.0 else (NEVER, NEVER)
    discriminant = b * b - 4.0 * a * c
    if discriminant < 0.0:
        return NEVER, NEVER
    q = -0.5 * (b + math.copysign(math.sqrt(discriminant), b))
    if q == 0.0:
        return 0.0, 0.0
    first, second = q / a, c / q
    return (first, second) if first <= second else (second, first)


@inline
def cubic_extrema(b, c, d, e, last):
    """Points in (0, last) where the cubic b t³ + c t² + d t + e changes sign, in order; padded with `last` to three."""
    left, right = quadratic_roots(3.0 * b, 2.0 * c, d)
    count = 0
    first = second = third = last
    low = 0.0
    for k in range(3):
        high = last
        if k == 0:
            high = min(max(left, 0.0), last)
        elif k == 1:
            high = min(max(right, 0.0), last)
        if high > low:
            at_low = cubic(b, c, d, e, low)
            at_high = cubic(b, c, d, e, high)
            if (at_low < 0.0) != (at_high < 0.0):
                zero = bisect(b, c, d, e, low, high)
                if count == 0:
                    first = zero
                elif count == 1:
                    second = zero
                else:
                    third = zero
                count += 1
            low = high
    return first, second, third


@inline
def gap(x, y, vx, vy, gx, gy, r, t):
    """Squared distance from the origin at time t on a parabola, minus r²; length².

    It is computed from the position at t, so that digits are not lost if r is small.
    """
    x_then = parabola(x, vx, gx, t)
    y_then = parabola(y, vy, gy, t)
    return x_then * x_then + y_then * y_then - r * r


@inline
def first_contact_root(x, y, vx, vy, gx, gy, r, after):
    """Smallest t ≥ 0 at which a body on a parabola is within r of the origin and approaches it; NEVER if there is none.

    x, y, r: length. vx, vy: length/time. gx, gy: length/time². Only an approach that begins after the time `after`
    counts.
    """
    return first_descent(x, y, vx, vy, gx, gy, r, after, 1.0)


@inline
def first_exit_root(x, y, vx, vy, gx, gy, r, after):
    """Smallest t ≥ 0 at which a body on a parabola is at least r from the origin and moves away; NEVER if it never is.

    The arguments are as in `first_contact_root`.
    """
    return first_descent(x, y, vx, vy, gx, gy, r, after, -1.0)


@noinline
def first_descent(x, y, vx, vy, gx, gy, r, after, sign):
    """Smallest t ≥ 0 at which the gap times `sign` (1 or -1) falls and is zero or less.

    The gap p(t) = a t⁴ + b t³ + c t² + d t + e is monotonic between its turning points, the zeros of p'; the first
    interval that ends at or below zero contains the root. If the gap is zero or less at t = 0 and falls there, the
    result is 0. If it rises there, the result is the next descent: to zero or, if the gap stays below zero until then,
    to its value at 0.
    """
    a = 0.25 * (gx * gx + gy * gy)
    b = gx * vx + gy * vy
    c = vx * vx + vy * vy + gx * x + gy * y
    d = 2.0 * (x * vx + y * vy)
    e = sign * gap(x, y, vx, vy, gx, gy, r, 0.0)
    if e <= 0.0 and sign * d < 0.0 and after < 0.0:
        return 0.0
    largest = max(max(abs(b), abs(c)), max(abs(d), abs(e)))
    last = 1.0 + largest / a  # Cauchy's bound on the roots
    bound = 2.0 * max(max(abs(b / a), math.sqrt(abs(c / a))), max(third_power(abs(d / a)), quarter_power(abs(e / a))))
    last = min(last, bound)  # Fujiwara's bound
    first, second, third = cubic_extrema(4.0 * a, 3.0 * b, 2.0 * c, d, last)
    low = 0.0
    for k in range(4):
        high = first if k == 0 else (second if k == 1 else (third if k == 2 else last))
        if high > low:
            at_low = sign * gap(x, y, vx, vy, gx, gy, r, low)
            at_high = sign * gap(x, y, vx, vy, gx, gy, r, high)
            level = min(e, 0.0) if low > 0.0 and at_low <= 0.0 else 0.0
            if low > after and at_high <= level and at_high < at_low:
                if at_low <= level:
                    return low
                for _ in range(BISECTIONS):
                    middle = 0.5 * (low + high)
                    if middle <= low or middle >= high:
                        break
                    if sign * gap(x, y, vx, vy, gx, gy, r, middle) > level:
                        low = middle
                    else:
                        high = middle
                return high
            low = high
    return NEVER
