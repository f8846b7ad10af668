"""Sheared sides of the box: Lees & Edwards, J. Phys. C 5, 1921 (1972).

The periodic image of the gas that lies k box heights above the box moves along x at velocity k u, where u is the shear
rate times the height of the box; at time t, this image is displaced by k u t. Because images move uniformly, contact
times through sheared sides are computed as for any two discs in free flight. A disc whose centre leaves through the top
re-enters at the bottom, displaced by -u t along x and with a velocity along x that is smaller by u.
"""

import math
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from idealgas.jit import inline
from idealgas.physics.disc_wall import arrival_delay
from idealgas.physics.motion import NEVER


class Shear(NamedTuple):
    """Shear of a box whose bottom and top are sheared sides.

    Attributes:
        rate: change of the mean velocity along x per length along y, 1/time.
        speed: velocity u of the periodic image above the box, length/time.
        Lx: width of the box, length.
        Ly: height of the box, length.
        offset: (2,) f8, displacement along x of the image above the box at the start and at the end of the epoch,
            length; whole widths of the box are subtracted so that the first value is less than Lx.
    """

    rate: float
    speed: float
    Lx: float
    Ly: float
    offset: np.ndarray


def make_shear(rate: float, size: tuple[float, float]) -> Shear:
    """Return the shear at time 0.

    rate: shear rate, 1/time. size: width and height of the box, length.
    """
    return Shear(rate, rate * size[1], *size, np.zeros(2))


def begin_epoch(shear: Shear, time: float, length: float) -> None:
    """Measure local times from a given time in the run, and compute the offset, which is rounded only once.

    time: time of the run at which the epoch begins. length: duration of the epoch, time.
    """
    ahead = float(Fraction(shear.speed) * Fraction(time) % Fraction(shear.Lx))
    shear.offset[:] = ahead, ahead + shear.speed * length


def at(shear: Shear | None, time: float) -> Shear | None:
    """Return the shear for an epoch of length 0 at a given time in the run; None without shear."""
    if shear is None:
        return None
    frozen = shear._replace(offset=np.zeros(2))
    begin_epoch(frozen, time, 0.0)
    return frozen


def longest_epoch(shear: Shear | None) -> float:
    """Longest duration of an epoch, time; infinite without shear.

    The duration is a power of two, such that the image above the box moves by at most the width of the box.
    """
    return math.inf if shear is None else 2.0 ** math.floor(math.log2(shear.Lx / shear.speed))


@inline
def offset_at(shear, time):
    """Displacement along x, at a local time, of the periodic image above the box, length."""
    return shear.offset[0] + shear.speed * time


@inline
def subtract_offset(x, vx, time, shear, images):
    """Subtract the displacement and velocity of an image from a relative position and velocity along x.

    x: length. vx: length/time. time: local time. images: numbers of box lengths (x, y) by which the image is shifted.
    """
    if shear is not None:
        return x - offset_at(shear, time) * images[1], vx - shear.speed * images[1]
    return x, vx


@inline
def less_offset_of_nearest(x, y, time, shear):
    """Convert a relative position (x, y), length, to the position relative to the nearest image along y.

    The displacement of this image along x is subtracted too. time: local time at which the displacement is computed.
    """
    if shear is not None:
        rows = np.rint(y / shear.Ly)
        return x - offset_at(shear, time) * rows, y - shear.Ly * rows
    return x, y


@inline
def enter_common_frame(a, b, shear, images):
    """Transform two discs' velocities to the frame midway between the frames of a's box and of the box of b's image."""
    if shear is not None:
        half = 0.5 * shear.speed * images[1]
        a.vx -= half
        b.vx += half


@inline
def leave_common_frame(a, b, shear, images):
    """Undo `enter_common_frame`."""
    if shear is not None:
        half = 0.5 * shear.speed * images[1]
        a.vx += half
        b.vx -= half


@inline
def set_velocities_along_x(a, b, shear, velocities):
    """Set the velocities along x of two discs if sides are sheared."""
    if shear is not None:
        a.vx, b.vx = velocities


@inline
def crossing_time(disc, side, length, shear, contact):
    """Local time at which a disc's centre reaches a sheared side, bottom (2) or top (3); NEVER if it does not.

    length: height of the box. If the sides are not sheared, the result is `contact`, the time at which the disc touches
    the side.
    """
    if shear is not None:
        upwards = disc.vy > 0.0
        if disc.vy == 0.0 or upwards != (side == 3):
            return NEVER
        return disc.t + arrival_delay(disc.y, disc.vy, length if upwards else 0.0)
    return contact


@inline
def cross(disc, side, shear):
    """When a disc crosses a sheared side, move it to the opposite one; return 1 if it crossed the top, or else -1.

    The state of the disc must be that at the time of the crossing. Its new x coordinate may be outside the box.
    """
    rows = 1 if side == 3 else -1
    disc.x -= offset_at(shear, disc.t) * rows
    disc.vx -= shear.speed * rows
    disc.y = 0.0 if side == 3 else shear.Ly
    return rows


@inline
def flow_at(y, rate, height):
    """Mean velocity along x at height y in a box of the given height, length/time; numbers or arrays."""
    return rate * (y - 0.5 * height)


@inline
def add_flow(disc, shear):
    """Add the mean flow velocity at a disc's position to the disc's velocity if sides are sheared."""
    if shear is not None:
        disc.vx += flow_at(disc.y, shear.rate, shear.Ly)
