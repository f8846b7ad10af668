"""First time at which a body on a parabola comes within a given distance of a point: a falling zero of a quartic."""

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
    """Value of x + v t + ½ a t²; the form x + (v + ½ a t) t is more precise when the body has nearly returned to x."""
    return x + (v + 0.5 * a * t) * t


@inline
def bisect(b, c, d, e, low, high):
    """Point in [low, high] where a cubic changes sign, to the last bit; the signs at the two ends must differ."""
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
    """Points in (0, last) where the cubic b t³ + c t² + d t + e changes sign, in increasing order.

    Returns three points; if there are fewer, the rest are set to `last`.
    """
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
def gap(x, y, disc, gravity, r, t):
    """Squared distance of a disc's centre from a point after a delay t on a parabola, minus r²; length².

    x, y: initial position relative to the point, length. The gap is computed from the position after the delay, so that
    no precision is lost if r is small.
    """
    x_then = parabola(x, disc.vx, gravity.x, t)
    y_then = parabola(y, disc.vy, gravity.y, t)
    return x_then * x_then + y_then * y_then - r * r


@inline
def first_contact_root(x, y, disc, gravity, r, after):
    """Delay until the centre of a disc on a parabola is within r of a point and approaches it; NEVER if it never is.

    x, y: position relative to the point, length. r: length. Only an approach that begins after the delay `after`
    counts.
    """
    return first_descent(x, y, disc, gravity, r, after, 1.0)


@inline
def first_exit_root(x, y, disc, gravity, r, after):
    """Delay until the centre of a disc on a parabola is at least r from a point and moves away; NEVER if it never is.

    The arguments are as in `first_contact_root`.
    """
    return first_descent(x, y, disc, gravity, r, after, -1.0)


@noinline
def first_descent(x, y, disc, gravity, r, after, sign):
    """Smallest t ≥ 0 at which p(t), the gap times `sign` (1 or -1), is falling and is zero or negative; NEVER if none.

    The gap is the quartic a t⁴ + b t³ + c t² + d t + e. Its leading coefficient a = |gravity|²/4 is positive, because
    an acceleration of zero counts as no gravity. The gap has at most three turning points and is monotonic between
    them:

        p
        │╲         ╱╲
        │ ╲       ╱  ╲
        ┼──●─────╱────●───┼──→ t
        │   ╲   ╱      ╲  │
        │    ╲_╱        ╲ │
        0   first second  last

    The result lies in the first interval between turning points in which p falls and ends at p ≤ 0. If p is positive at
    the beginning of this interval, the interval contains a single zero ●, which bisection finds to the last bit. If p
    is already zero or negative there, the result is the beginning of the interval. Bisection evaluates the gap itself,
    because the closed formula for the zeros of a quartic would lose digits by cancellation.

    There are no zeros beyond `last`, because all zeros satisfy |t| ≤ 1 + max(|b|, |c|, |d|, |e|)/a (Cauchy) and |t| ≤ 2
    max(|b/a|, |c/a|^½, |d/a|^⅓, |e/a|^¼) (Fujiwara).

    A disc may start at p ≤ 0: in contact or, because of rounding or a gate that has closed on it, in overlap. If p
    falls at once, the result is 0. If p rises, the disc moves away, and the result is the time at which p falls again
    to 0 or, if p does not reach 0 before it falls, to its initial value; the overlap therefore does not grow. The
    bounds hold for this initial value too: if it is subtracted from p, all coefficients remain the same except e, which
    becomes 0.
    """
    vx, vy, gx, gy = disc.vx, disc.vy, gravity.x, gravity.y
    a = 0.25 * (gx * gx + gy * gy)
    b = gx * vx + gy * vy
    c = vx * vx + vy * vy + gx * x + gy * y
    d = 2.0 * (x * vx + y * vy)
    e = sign * gap(x, y, disc, gravity, r, 0.0)
    if e <= 0.0 and sign * d < 0.0 and after < 0.0:
        return 0.0
    largest = max(max(abs(b), abs(c)), max(abs(d), abs(e)))
    cauchy = 1.0 + largest / a
    term = max(max(abs(b / a), math.sqrt(abs(c / a))), max(third_power(abs(d / a)), quarter_power(abs(e / a))))
    last = min(cauchy, 2.0 * term)  # Fujiwara's bound
    first, second, third = cubic_extrema(4.0 * a, 3.0 * b, 2.0 * c, d, last)
    low, at_low = 0.0, e
    for high in (first, second, third, last):
        at_high = sign * gap(x, y, disc, gravity, r, high)
        level = min(e, 0.0) if low > 0.0 and at_low <= 0.0 else 0.0
        if low > after and at_high < at_low and at_high <= level:
            if at_low <= level:
                return low
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                if middle <= low or middle >= high:
                    break
                if sign * gap(x, y, disc, gravity, r, middle) > level:
                    low = middle
                else:
                    high = middle
            return high
        low, at_low = high, at_high
    return NEVER
