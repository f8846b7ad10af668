"""Sheared sides of the box: Lees & Edwards, J. Phys. C 5, 1921 (1972).

The image of the gas k boxes up moves along x with the velocity k u, where u is the shear rate times the height of the
box; at the time t it is k u t ahead. Images move uniformly, so contact times through the sheared sides are the same as
for two discs in free flight. A disc whose centre leaves through the top enters at the bottom, u t further to the left
and slower by u.
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
        speed: velocity of the image above, u, length/time.
        Lx: width of the box, length.
        Ly: height of the box, length.
        offset: (2,) f8, distance by which the image above is ahead at the start and at the end of the epoch, length;
            whole widths of the box at the start are subtracted.
    """

    rate: float
    speed: float
    Lx: float
    Ly: float
    offset: np.ndarray


def make_shear(rate: float, size: tuple[float, float]) -> Shear:
    """Shear at time 0 in a box of the given width and height, length; rate: 1/time."""
    return Shear(rate, rate * size[1], *size, np.zeros(2))


def begin_epoch(shear: Shear, time: float, length: float) -> None:
    """Let local times count from a time of the run; the offset is exact. length: duration of the epoch."""
    ahead = float(Fraction(shear.speed) * Fraction(time) % Fraction(shear.Lx))
    shear.offset[:] = ahead, ahead + shear.speed * length


def at(shear: Shear | None, time: float) -> Shear | None:
    """Return the shear for an epoch of length 0 at a time of the run; None without shear."""
    if shear is None:
        return None
    frozen = shear._replace(offset=np.zeros(2))
    begin_epoch(frozen, time, 0.0)
    return frozen


def longest_epoch(shear: Shear | None) -> float:
    """Longest epoch, time: a power of two, in which the image above moves by at most one width of the box."""
    return math.inf if shear is None else 2.0 ** math.floor(math.log2(shear.Lx / shear.speed))


@inline
def offset_at(shear, time):
    """Distance by which the image above is ahead at a local time, length."""
    return shear.offset[0] + shear.speed * time


@inline
def subtract_offset(x, vx, time, shear, images):
    """Subtract the displacement and velocity of an image from a relative position and velocity along x.

    x: length. vx: length/time. time: local time. images: numbers of box lengths (x, y) to the image.
    """
    if shear is not None:
        return x - offset_at(shear, time) * images[1], vx - shear.speed * images[1]
    return x, vx


@inline
def less_offset_of_nearest(x, y, time, shear):
    """Subtract the displacement of the nearest image along y from a relative position (x, y), length; time: local."""
    if shear is not None:
        rows = np.rint(y / shear.Ly)
        return x - offset_at(shear, time) * rows, y - shear.Ly * rows
    return x, y


@inline
def enter_common_frame(a, b, shear, images):
    """Transform the velocities of two discs to the frame half-way between the box of a and the box of b's image."""
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
    """Set the velocities along x of two records, if sides are sheared."""
    if shear is not None:
        a.vx, b.vx = velocities


@inline
def crossing_time(disc, side, length, shear, contact):
    """Local time at which a disc's centre reaches a sheared side, bottom (2) or top (3); NEVER if it does not.

    If the sides are not sheared, it is `contact`, the time of the disc's contact with the side.
    """
    if shear is not None:
        upwards = disc.vy > 0.0
        if disc.vy == 0.0 or upwards != (side == 3):
            return NEVER
        return disc.t + arrival_delay(disc.y, disc.vy, length if upwards else 0.0)
    return contact


@inline
def cross(disc, side, shear):
    """Move a disc's record, at the time of its crossing, to the opposite side; return the box lengths upwards, 1 or -1.

    Afterwards its position along x may be outside the box.
    """
    rows = 1 if side == 3 else -1
    disc.x -= offset_at(shear, disc.t) * rows
    disc.vx -= shear.speed * rows
    disc.y = 0.0 if side == 3 else shear.Ly
    return rows


@inline
def flow_at(y, rate, height):
    """Mean velocity along x at a height y in a box of the given height, length/time; numbers or arrays."""
    return rate * (y - 0.5 * height)


@inline
def add_flow(disc, shear):
    """Add the mean velocity at a disc's position to its velocity, if sides are sheared."""
    if shear is not None:
        disc.vx += flow_at(disc.y, shear.rate, shear.Ly)
