"""Random collisions in a homogeneous gas: the rate at which a pair of discs collides, and where they touch.

Discs with the sum of radii S and the relative speed v sweep the area 2Sv per time, out of the box's area A. A pair
without positions thus collides at the rate 2Sχv/A; χ is the contact value of the pair distribution, 1 in a dilute gas.
Trials are made at the rate of the fastest possible pair, and accepted in the ratio of the rates: Novak & Bortz, Am. J.
Phys. 38, 1402 (1970); Eger & Kress, Am. J. Phys. 50, 120 (1982).
"""

import math

from idealgas.jit import inline
from idealgas.physics.contact_value import contact_value


def mean_trial_time(number: int, area: float, packing_fraction: float, largest_reach: float, v_ref: float) -> float:
    """Mean time between trials, A/(N(N - 1) S χ v_ref).

    number: N, discs. area: A, length². packing_fraction: gives χ. largest_reach: S, largest sum of two radii, length.
    v_ref: largest relative speed foreseen, length/time.

    N(N - 1)/2 pairs are tried, each at the rate 2Sχv_ref/A. In equilibrium a disc then collides at the rate (1 - 1/N)
    2Snχ√(πT/m) of kinetic theory.
    """
    pairs = number * (number - 1)
    return area / (pairs * largest_reach * contact_value(packing_fraction) * v_ref)


@inline
def touch_at_random(a, b, offset):
    """Set the relative position of two records at a random contact: b at the origin, a along the line of centres.

    offset: impact parameter divided by the sum of the radii, -1 to 1; it is the sine of the angle from the relative
    velocity to the line of centres. The distance from b to a does not matter to the collision law and is set to the
    relative speed: with unit vectors the rounding in `collide` would be biased, and the energy would grow by half a
    last digit per collision.
    """
    vx = a.vx - b.vx
    vy = a.vy - b.vy
    cosine = math.sqrt(1.0 - offset * offset)
    a.x = -(cosine * vx + offset * vy)
    a.y = -(cosine * vy - offset * vx)
    b.x = 0.0
    b.y = 0.0
