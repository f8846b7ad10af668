"""Collision of two discs: the time of contact, and the velocities after the collision.

Both laws are symmetric to the last bit under exchange of the discs, because differences only change sign. For smooth
elastic discs they work in any precision, see `arithmetic`. The arguments a and b are the stored states of two discs,
which may be any objects with the fields x, y, vx, vy, t, r and m.
"""

import math

from idealgas.jit import inline, noinline
from idealgas.physics.arithmetic import changed, correction, number, root
from idealgas.physics.motion import NEVER
from idealgas.physics.periodic import shift_by_images
from idealgas.physics.restitution import restitution_factor
from idealgas.physics.rotation import tangential_impulse
from idealgas.physics.shear import enter_common_frame, set_velocities_along_x, subtract_offset


@inline
def relative_motion(a, b, gravity, periodic, images):
    """The later of two discs' local times, and the position and velocity of disc a relative to disc b at that time.

    Returns (time, x, y, vx, vy), in units of time, length and length/time.
    """
    time = a.t if a.t > b.t else b.t
    a_dt = time - a.t
    b_dt = time - b.t
    x = (a.x - b.x) + (a.vx * a_dt - b.vx * b_dt)
    y = (a.y - b.y) + (a.vy * a_dt - b.vy * b_dt)
    vx = a.vx - b.vx
    vy = a.vy - b.vy
    if gravity is not None:
        ahead = 0.5 * (a_dt * a_dt - b_dt * b_dt)
        x += gravity.x * ahead
        y += gravity.y * ahead
        vx += gravity.x * (a_dt - b_dt)
        vy += gravity.y * (a_dt - b_dt)
    if periodic is not None:
        x, y = shift_by_images(x, y, periodic, images)
        x, vx = subtract_offset(x, vx, time, periodic.shear, images)
    return time, x, y, vx, vy


@inline
def collision_discriminant(x, y, vx, vy, reach):
    """Whether a point in straight flight comes within `reach` of the origin, and the coefficients that determine when.

    x, y, reach: length. vx, vy: length/time. Returns (meets, approach b = r·v, gap c = r² - S², discriminant D), where
    r is the position, v the velocity and S the reach.

    The form D = v²S² - (v × r)² keeps its precision for a grazing pair (Bannerman et al., Comput. Part. Mech. 1, 191
    (2014)). A pair with D = 0 does not count as touching, because the collision would change nothing, and for discs
    that slide past each other rounding would make the time c/|b| arbitrary. The code has no branches.
    """
    approach = x * vx + y * vy
    gap = x * x + y * y - reach * reach
    cross = vx * y - vy * x
    discriminant = (vx * vx + vy * vy) * (reach * reach) - cross * cross
    zero = number(0.0, x)
    return (approach < zero) & ((discriminant > zero) | (gap <= zero)), approach, gap, discriminant


@inline
def collision_delay(x, y, vx, vy, reach):
    """Whether a point in straight flight comes within `reach` of the origin, and the time until it does.

    The arguments are as in `collision_discriminant`. The delay is 0 for an approaching point that is already within
    reach. The time is computed as c/(√D - b), the root of its quadratic equation in which no digits cancel for small c.
    """
    meets, approach, gap, discriminant = collision_discriminant(x, y, vx, vy, reach)
    zero = number(0.0, x)
    return meets, max(gap, zero) / (root(max(discriminant, zero)) - approach)


@inline
def will_collide(a, b, gravity, periodic, images):
    """Whether two discs approach each other and touch now or later; faster than `collision_time`."""
    _, x, y, vx, vy = relative_motion(a, b, gravity, periodic, images)
    return collision_discriminant(x, y, vx, vy, a.r + b.r)[0]


@inline
def collision_time(a, b, gravity, periodic, images):
    """Local time at which two approaching discs touch; NEVER if they do not.

    If the approaching discs already touch or overlap at the later of their local times, that time is returned.
    """
    time, x, y, vx, vy = relative_motion(a, b, gravity, periodic, images)
    meets, delay = collision_delay(x, y, vx, vy, a.r + b.r)
    return time + delay if meets else number(NEVER, time)


@inline
def contact_time(a, b, a_id, b_id, images, gravity, periodic, effects):
    """Local time of the next collision of discs a and b; NEVER if there is none.

    Touching discs whose collision would not change any digit of their velocities count as having collided already. The
    result therefore differs from `collision_time` only for some discs that touch at the later of their local times.
    """
    touched = collision_time(a, b, gravity, periodic, images)
    if (touched == max(a.t, b.t)) and changes_nothing(a, b, a_id, b_id, images, gravity, periodic, effects):
        return number(NEVER, touched)
    return touched


@noinline
def changes_nothing(a, b, a_id, b_id, images, gravity, periodic, effects):
    """Whether a collision at the later of the two local times would leave every digit of the velocities unchanged."""
    time, x, y, vx, vy = relative_motion(a, b, gravity, periodic, images)
    factor = restitution_factor(effects.restitution, a_id, b_id, time)
    before = a.vx, b.vx
    if periodic is not None:
        enter_common_frame(a, b, periodic.shear, images)
    a_vx, a_vy, b_vx, b_vy = velocities_after(a, b, x, y, vx, vy, factor)
    unchanged = (a_vx == a.vx) & (a_vy == a.vy) & (b_vx == b.vx) & (b_vy == b.vy)
    if periodic is not None:
        set_velocities_along_x(a, b, periodic.shear, before)
    return unchanged


@inline
def velocities_after(a, b, x, y, vx, vy, factor):
    """Velocities (a_vx, a_vy, b_vx, b_vy) of two discs after the normal impulse of a collision, length/time.

    x, y: position of a relative to b, length. vx, vy: velocity of a relative to b, length/time. factor: 1 + the
    coefficient of restitution.
    """
    f = number(factor, x)
    k = f * (x * vx + y * vy) / ((x * x + y * y) * (a.m + b.m))
    to_a, to_b = number(0.0, k) - k * b.m, k * a.m
    a_dx, a_dy, b_dx, b_dy = to_a * x, to_a * y, to_b * x, to_b * y
    a_excess = (f * a.vx + a_dx) * a_dx + (f * a.vy + a_dy) * a_dy
    b_excess = (f * b.vx + b_dx) * b_dx + (f * b.vy + b_dy) * b_dy
    work = a.m * (a_dx * a_dx + a_dy * a_dy) + b.m * (b_dx * b_dx + b_dy * b_dy)
    c = correction(a.m * a_excess + b.m * b_excess, work)
    return changed(a.vx, a_dx, c), changed(a.vy, a_dy, c), changed(b.vx, b_dx, c), changed(b.vy, b_dy, c)


@inline
def collide(a, b, a_id, b_id, images, rotation, periodic, effects):
    """Change the velocities and spins of two colliding discs, whose stored states must be at the time of contact.

    If sides are sheared, the velocities must be in the common frame, see `enter_common_frame`.
    """
    x, y = a.x - b.x, a.y - b.y
    if periodic is not None:
        x, y = shift_by_images(x, y, periodic, images)
        x, _ = subtract_offset(x, a.vx, a.t, periodic.shear, images)
    if rotation is not None:
        tangential_impulse(a, b, a_id, b_id, x, y, rotation)
    factor = restitution_factor(effects.restitution, a_id, b_id, a.t)
    a.vx, a.vy, b.vx, b.vy = velocities_after(a, b, x, y, a.vx - b.vx, a.vy - b.vy, factor)


@inline
def random_contact(a, b, offset):
    """Place two discs in contact with a given impact parameter: disc b at the origin, disc a on the line of centres.

    offset: impact parameter divided by the sum of the radii, -1 to 1; this is the sine of the angle from the relative
    velocity to the line of centres. Because the distance between the discs does not enter the collision law, the
    distance is set to the relative speed. With unit vectors, the rounding in `collide` would be biased, and the energy
    would grow by half a unit in the last place per collision.
    """
    vx = a.vx - b.vx
    vy = a.vy - b.vy
    cosine = math.sqrt(1.0 - offset * offset)
    a.x = -(cosine * vx + offset * vy)
    a.y = -(cosine * vy - offset * vx)
    b.x = 0.0
    b.y = 0.0
