"""A piston: a wall across the box that moves along one axis, at a given velocity or with a mass under a pressure.

Between hits it falls: X(t) = X₀ + V t + ½ A t²; A comes from the outer pressure and gravity (0 at a given velocity).
"""

import numpy as np

from idealgas._jit import inline
from idealgas.physics.constants import NEVER
from idealgas.physics.fall import time_to_plane
from idealgas.physics.gravity import acceleration_along
from idealgas.physics.motion import position_after, velocity_after
from idealgas.physics.restitution import wall_rebound

PISTON = np.dtype(
    [
        ("x", "f8"), ("v", "f8"), ("a", "f8"),  # position, velocity, acceleration along the axis
        ("t", "f8"),  # local time of the record
        ("m", "f8"),  # mass; 0: moves at a given velocity whatever hits it
        ("stop", "f8"),  # position of the end stop, the side of the box that it stands for
        ("side", "i4"), ("count", "u4"),
    ],
    align=True,
)  # fmt: skip


@inline
def outward(piston):
    """+1 if the gas is below the piston's coordinate, -1 if above."""
    return 1.0 if piston.side & 1 else -1.0


@inline
def piston_motion(piston, time):
    """Position and velocity of a piston at a later local time, if it meets nothing until then."""
    delay = time - piston.t
    return position_after(piston.x, piston.v, piston.a, delay), velocity_after(piston.v, piston.a, delay)


def end_epoch(piston: np.ndarray, length: float) -> None:
    """Bring the piston to the end of an epoch, and count its local time from there."""
    advance_piston(piston[0], length)
    piston[0].t = 0.0


@inline
def piston_contact(disc, piston, gravity):
    """Time at which a disc meets the piston; NEVER if it does not."""
    along_y = piston.side >= 2
    sign = outward(piston)
    time = max(disc.t, piston.t)
    d_dt = time - disc.t
    pull = acceleration_along(gravity, along_y)
    place, velocity = (disc.y, disc.vy) if along_y else (disc.x, disc.vx)
    d_place = position_after(place, velocity, pull, d_dt)
    d_velocity = velocity_after(velocity, pull, d_dt)
    p_place, p_velocity = piston_motion(piston, time)
    height = sign * (p_place - d_place) - disc.r
    delay = time_to_plane(height, sign * (p_velocity - d_velocity), sign * (piston.a - pull))
    return time + delay if delay < NEVER else NEVER


@inline
def stop_contact(piston):
    """Time at which the piston meets its end stop."""
    sign = outward(piston)
    delay = time_to_plane(sign * (piston.stop - piston.x), -sign * piston.v, -sign * piston.a)
    return piston.t + delay if delay < NEVER else NEVER


@inline
def advance_piston(piston, time):
    """Move the piston's record to a later time.

    The way is summed before it is added, other than in `piston_motion`: events on record depend on its last digit.
    """
    delay = time - piston.t
    piston.x += position_after(0.0, piston.v, piston.a, delay)
    piston.v = velocity_after(piston.v, piston.a, delay)
    piston.t = time


def piston_energy(mass, position, velocity, acceleration):
    """Energy of motion and place of a piston with a mass, m (V²/2 - A X), constant between hits. Numbers or arrays.

    acceleration: along its way between hits, by the outer pressure and gravity.
    """
    return mass * (0.5 * velocity**2 - acceleration * position)


@inline
def collide_with_piston(disc, own, piston, restitution):
    """Exchange momentum along the axis; returns nothing, both records stand at the contact."""
    along_y = piston.side >= 2
    velocity = disc.vy if along_y else disc.vx
    factor = wall_rebound(restitution, own, disc.t)
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
def is_piston_side(side, piston):
    """Whether the piston stands before a side."""
    if piston is not None:
        return side == piston[0].side
    return False
