"""A piston: a wall across the box that moves along one axis, with a prescribed velocity or with a finite mass.

An outer piston replaces a side of the box and may be pressed from outside; an inner piston has gas on both sides.
Between hits a piston moves as X(t) = X₀ + V t + ½ A t². The acceleration A is due to the external pressure and gravity;
it is 0 if the velocity is prescribed. A piston is reflected at the two sides of the box that are perpendicular to its
axis.
"""

import numpy as np

from idealgas.jit import inline
from idealgas.physics.gravity import acceleration_along
from idealgas.physics.motion import NEVER, position_after, stays_above, time_to_plane, velocity_after
from idealgas.physics.restitution import wall_restitution_factor

PISTON = np.dtype(
    [
        ("x", "f8"), ("v", "f8"), ("a", "f8"),  # position, velocity, acceleration along the axis, length and time
        ("t", "f8"),  # local time of this position and velocity
        ("m", "f8"),  # mass; 0 for a piston with a prescribed velocity, which hits do not change
        ("length", "f8"),  # length of the box along the axis
        ("outward", "f8"),  # direction from the gas to an outer piston along its axis, +1 or -1; 0 for an inner piston
        ("wall", "i4"), ("axis", "i4"),  # number of the piston among the walls; 0 if it moves along x, 1 along y
        ("count", "u4"),  # number of events that changed the velocity
    ],
    align=True,
)  # fmt: skip


@inline
def outward(piston, distance):
    """Direction along the axis from a disc to the piston, +1 or -1.

    distance: coordinate of the piston minus coordinate of the disc, length. For an outer piston the direction is fixed,
    so a disc that rounding has put beyond the piston returns. Discs never pass an inner piston.
    """
    if piston.outward != 0.0:
        return piston.outward
    return 1.0 if distance > 0.0 else -1.0


@inline
def piston_motion(piston, time):
    """Position (length) and velocity (length/time) of the piston at a later local time.

    No disc may hit the piston before this time.
    """
    delay = time - piston.t
    return position_after(piston.x, piston.v, piston.a, delay), velocity_after(piston.v, piston.a, delay)


def end_epoch(pistons: np.ndarray, length: float) -> None:
    """Move all pistons to the end of an epoch, from which their local times then count.

    length: duration of the epoch, time.
    """
    for piston in pistons:
        advance_piston(piston, length)
        piston.t = 0.0


@inline
def height_over_piston(disc, piston, gravity):
    """The later of the local times of a disc and the piston, and the disc's motion relative to the piston at that time.

    Returns (time, height, velocity, acceleration). The height is the distance between the disc's edge and the piston;
    all three components are positive if they point away from the piston.
    """
    along_y = piston.axis == 1
    time = max(disc.t, piston.t)
    d_dt = time - disc.t
    pull = acceleration_along(gravity, along_y)
    position, velocity = (disc.y, disc.vy) if along_y else (disc.x, disc.vx)
    d_position = position_after(position, velocity, pull, d_dt)
    d_velocity = velocity_after(velocity, pull, d_dt)
    p_position, p_velocity = piston_motion(piston, time)
    distance = p_position - d_position
    sign = outward(piston, distance)
    height = sign * distance - disc.r
    return time, height, sign * (p_velocity - d_velocity), sign * (piston.a - pull)


@inline
def piston_contact(disc, piston, gravity):
    """Local time at which a disc touches the piston; NEVER if it does not."""
    time, height, velocity, acceleration = height_over_piston(disc, piston, gravity)
    delay = time_to_plane(height, velocity, acceleration)
    return time + delay if delay < NEVER else NEVER


@inline
def misses_piston_until(disc, piston, gravity, limit):
    """Whether it is certain that a disc does not touch the piston up to a local time `limit`.

    This test is faster than `piston_contact`. It extends slightly beyond the limit, so that rounding does not matter.
    """
    time, height, velocity, acceleration = height_over_piston(disc, piston, gravity)
    return stays_above(height, velocity, acceleration, limit * (1.0 + 1e-9) - time)


@inline
def stop_contact(piston):
    """Local time at which the piston reaches a side of the box; NEVER if it does not."""
    upper = time_to_plane(piston.length - piston.x, -piston.v, -piston.a)
    delay = min(time_to_plane(piston.x, piston.v, piston.a), upper)
    return piston.t + delay if delay < NEVER else NEVER


@inline
def advance_piston(piston, time):
    """Move the piston to a later local time.

    Unlike in `piston_motion`, the displacement is computed first and then added to the position. This order must not
    change, because the last digits of logged events depend on it.
    """
    delay = time - piston.t
    piston.x += position_after(0.0, piston.v, piston.a, delay)
    piston.v = velocity_after(piston.v, piston.a, delay)
    piston.t = time


def piston_energy(mass, position, velocity, acceleration):
    """Kinetic and potential energy m (V²/2 - A X) of a piston of finite mass, mass length²/time².

    This energy is constant between hits. position: length. velocity: length/time. acceleration: acceleration between
    hits, due to the external pressure and gravity, length/time². Numbers or arrays.
    """
    return mass * (0.5 * velocity**2 - acceleration * position)


@inline
def collide_with_piston(disc, disc_id, piston, restitution):
    """Exchange momentum along the axis between a disc and the piston, which must both be at the time of contact."""
    along_y = piston.axis == 1
    velocity = disc.vy if along_y else disc.vx
    factor = wall_restitution_factor(restitution, disc_id, disc.t)
    approach = velocity - piston.v
    if piston.m > 0.0:
        velocity -= factor * piston.m / (disc.m + piston.m) * approach
        piston.v += factor * disc.m / (disc.m + piston.m) * approach
        piston.count += np.uint32(1)
    else:
        velocity -= factor * approach
    if along_y:
        disc.vy = velocity
    else:
        disc.vx = velocity


@inline
def energy_at_piston(disc, energy, piston):
    """Energy that an elastic collision with the piston would conserve, mass length²/time².

    For a piston of finite mass, this is the sum of the kinetic energies of the disc and the piston. If the velocity of
    the piston is prescribed, it is the kinetic energy of the disc's motion along the axis in the frame of the piston.
    energy: kinetic energy of the disc.
    """
    if piston.m > 0.0:
        return energy + 0.5 * piston.m * piston.v * piston.v
    approach = (disc.vy if piston.axis == 1 else disc.vx) - piston.v
    return 0.5 * disc.m * approach * approach


@inline
def is_piston_side(side, piston):
    """Whether a piston replaces this side of the box."""
    if piston is not None:
        for k in range(len(piston)):
            if side == piston[k].wall:
                return True
    return False


@inline
def normal_of_piston(disc, piston):
    """Unit normal (x, y) of the piston towards a disc; both must be at the same local time."""
    position = disc.y if piston.axis == 1 else disc.x
    sign = outward(piston, piston.x - position)
    return (0.0, -sign) if piston.axis == 1 else (-sign, 0.0)
