"""Rough discs: the tangential impulse that couples translation and spin, with a constant coefficient of roughness.

Perfectly rough discs (roughness 1) and smooth discs (roughness -1) conserve energy. Sources: Chapman & Cowling, The
Mathematical Theory of Non-Uniform Gases, 11.2; Brilliantov & Pöschel, Kinetic Theory of Granular Gases, 2.2.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.jit import inline
from idealgas.physics.arithmetic import changed, correction


class Rotation(NamedTuple):
    """Spins and moments of inertia of the discs, and coefficients of roughness.

    Attributes:
        omega: (N,) f8 by id, angular velocity, 1/time.
        inertia: (N,) f8 by id, moment of inertia, mass length².
        roughness: coefficient of tangential restitution for two discs, from -1 (smooth) to 1 (perfectly rough).
        wall_roughness: coefficient of tangential restitution for a disc and a wall, from -1 to 1.
    """

    omega: np.ndarray
    inertia: np.ndarray
    roughness: float
    wall_roughness: float


def moment_of_inertia(inertia, mass, radius):
    """Moment of inertia I = κ m R² of a disc, mass length²; numbers or arrays of the same shape.

    inertia: coefficient κ, ½ for a uniform disc. mass: m. radius: R, length.
    """
    return inertia * mass * radius**2


@inline
def tangential_impulse(a, b, a_id, b_id, x, y, rotation):
    """Apply the tangential impulse of two touching discs to their velocities and spins.

    x, y: position of a relative to b, length.
    """
    u = np.uintp(a_id)
    w = np.uintp(b_id)
    distance = math.sqrt(x * x + y * y)
    tx = y / distance  # t = z × n with n = -(x, y)/distance, from a to b
    ty = -x / distance
    slip = (a.vx - b.vx) * tx + (a.vy - b.vy) * ty + (a.r * rotation.omega[u] + b.r * rotation.omega[w])
    a_mobility = 1.0 / a.m + a.r * a.r / rotation.inertia[u]
    b_mobility = 1.0 / b.m + b.r * b.r / rotation.inertia[w]
    factor = 1.0 + rotation.roughness
    impulse = -factor * slip / (a_mobility + b_mobility)
    a_excess, a_work = _rounding(a, u, tx, ty, impulse, factor, rotation)
    b_excess, b_work = _rounding(b, w, -tx, -ty, impulse, factor, rotation)
    c = correction(a_excess + b_excess, a_work + b_work)
    _apply(a, u, tx, ty, impulse, c, rotation)
    _apply(b, w, -tx, -ty, impulse, c, rotation)


@inline
def _rounding(disc, u, tx, ty, impulse, factor, rotation):
    """Excess energy of a disc due to rounding, and the derivative of this energy with respect to the correction."""
    dx, dy = impulse / disc.m * tx, impulse / disc.m * ty
    spin = disc.r / rotation.inertia[u] * impulse
    motion = (factor * disc.vx + dx) * dx + (factor * disc.vy + dy) * dy
    excess = disc.m * motion + rotation.inertia[u] * ((factor * rotation.omega[u] + spin) * spin)
    return excess, disc.m * (dx * dx + dy * dy) + rotation.inertia[u] * (spin * spin)


@inline
def _apply(disc, u, tx, ty, impulse, correction, rotation):
    """Apply an impulse along (tx, ty), with a relative correction, to a disc's velocity and spin."""
    disc.vx = changed(disc.vx, impulse / disc.m * tx, correction)
    disc.vy = changed(disc.vy, impulse / disc.m * ty, correction)
    rotation.omega[u] = changed(rotation.omega[u], disc.r / rotation.inertia[u] * impulse, correction)


@inline
def tangential_impulse_at_wall(disc, disc_id, nx, ny, rotation):
    """Apply the tangential impulse of a wall at rest to the velocity and spin of a disc that touches it."""
    u = np.uintp(disc_id)
    tx = ny  # the wall takes the place of the second disc, so n, from the disc to the wall, is -(nx, ny)
    ty = -nx
    slip = disc.vx * tx + disc.vy * ty + disc.r * rotation.omega[u]
    mobility = (nx * nx + ny * ny) / disc.m + disc.r * disc.r / rotation.inertia[u]
    factor = 1.0 + rotation.wall_roughness
    impulse = -factor * slip / mobility
    c = correction(*_rounding(disc, u, tx, ty, impulse, factor, rotation))
    _apply(disc, u, tx, ty, impulse, c, rotation)
