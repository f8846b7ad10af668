"""Two discs of a homogeneous gas that meet at random: how often a pair does, and where they touch.

Discs whose radii add up to S and that approach at speed v sweep 2Sv of the area A per time, so that a pair without
positions meets at the rate 2Sχv/A; χ is the contact value of the pair distribution, 1 in a dilute gas. Trials are made
at the rate of the fastest pair there may be, and accepted in the ratio of the rates: Novak & Bortz, Am. J. Phys. 38,
1402 (1970); Eger & Kress, Am. J. Phys. 50, 120 (1982).
"""

import math

from idealgas._jit import inline
from idealgas.physics.contact_value import contact_value


def mean_trial_time(number: int, area: float, packing_fraction: float, largest_reach: float, v_ref: float) -> float:
    """Mean time from one trial to the next: A/(N(N - 1) S χ v_ref), with the largest S of any pair.

    N(N - 1)/2 pairs are tried, each at the rate 2Sχv_ref/A. In equilibrium a disc then collides at the rate
    (1 - 1/N) 2Snχ√(πT/m) of kinetic theory.
    """
    pairs = number * (number - 1)
    return area / (pairs * largest_reach * contact_value(packing_fraction) * v_ref)


@inline
def touch_at_random(a, b, offset):
    """Put record a where it touches b, which comes to the origin.

    offset: impact parameter over the sum of the radii, -1 to 1: the sine of the angle of the line of centres to the
    relative velocity. Its length, which does not matter, is left to be the relative speed: with unit vectors the
    rounding in `collide` would be biased, and the energy grow by half a last digit per collision.
    """
    vx = a.vx - b.vx
    vy = a.vy - b.vy
    cosine = math.sqrt(1.0 - offset * offset)
    a.x = -(cosine * vx + offset * vy)
    a.y = -(cosine * vy - offset * vx)
    b.x = 0.0
    b.y = 0.0
