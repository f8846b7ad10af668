"""Two smooth elastic discs: when they touch and how they part.

Both laws are symmetric to the last bit under exchange of the discs: every difference only changes its sign.
"""

import math

from idealgas._jit import inline
from idealgas.physics.constants import NEVER


@inline
def relative_motion(a, b):
    """Later of the two records' times, and position and velocity of a relative to b at that time."""
    time = a.t if a.t > b.t else b.t
    a_dt = time - a.t
    b_dt = time - b.t
    x = (a.x - b.x) + (a.vx * a_dt - b.vx * b_dt)
    y = (a.y - b.y) + (a.vy * a_dt - b.vy * b_dt)
    return time, x, y, a.vx - b.vx, a.vy - b.vy


@inline
def first_touch(a, b):
    """Time at which approaching discs touch, or of the later record if they touch or overlap by then; else NEVER.

    The root c/(√D - b) of the distance equation has no cancellation for small c, and D = v²S² - (v × r)² keeps its
    digits in a grazing pair (Bannerman et al., Comput. Part. Mech. 1, 191 (2014)). Free of branches.
    """
    time, x, y, vx, vy = relative_motion(a, b)
    approach = x * vx + y * vy
    reach = a.r + b.r
    gap = x * x + y * y - reach * reach
    cross = vx * y - vy * x
    discriminant = (vx * vx + vy * vy) * (reach * reach) - cross * cross
    delay = max(gap, 0.0) / (math.sqrt(max(discriminant, 0.0)) - approach)
    return time + delay if (approach < 0.0) & ((discriminant >= 0.0) | (gap <= 0.0)) else NEVER


@inline
def contact_time(a, b):
    """Time of the next collision of a and b; NEVER if there is none.

    Touching discs whose collision would not change a digit of any velocity are done with each other. This differs from
    `first_touch` only where that gives the time of a record.
    """
    touch = first_touch(a, b)
    if touch == max(a.t, b.t):
        _, x, y, vx, vy = relative_motion(a, b)
        k = 2.0 * (x * vx + y * vy) / ((x * x + y * y) * (a.m + b.m))
        unchanged = (
            (a.vx - k * b.m * x == a.vx)
            & (a.vy - k * b.m * y == a.vy)
            & (b.vx + k * a.m * x == b.vx)
            & (b.vy + k * a.m * y == b.vy)
        )
        if unchanged:
            return NEVER
    return touch


@inline
def collide(a, b):
    """Exchange the normal momentum of two discs whose records stand at the contact."""
    x = a.x - b.x
    y = a.y - b.y
    approach = x * (a.vx - b.vx) + y * (a.vy - b.vy)
    k = 2.0 * approach / ((x * x + y * y) * (a.m + b.m))
    a.vx -= k * b.m * x
    a.vy -= k * b.m * y
    b.vx += k * a.m * x
    b.vy += k * a.m * y
