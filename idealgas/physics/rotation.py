"""Rough discs: the tangential impulse that couples motion and spin, with a constant coefficient of roughness.

Chapman & Cowling, The Mathematical Theory of Non-Uniform Gases, 11.2; Brilliantov & Pöschel, Kinetic Theory of Granular
Gases, 2.2. Discs of roughness 1 conserve energy, discs of roughness -1 are smooth.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.jit import inline


class Rotation(NamedTuple):
    """Spins and moments of inertia of the discs, and coefficients of roughness.

    Attributes:
        omega: (N,) f8 by id, angular velocity, 1/time.
        inertia: (N,) f8 by id, moment of inertia, mass length².
        roughness: coefficient of tangential restitution of two discs, from -1 (smooth) to 1 (perfectly rough).
        wall_roughness: coefficient of tangential restitution of a disc and a wall, from -1 to 1.
    """

    omega: np.ndarray
    inertia: np.ndarray
    roughness: float
    wall_roughness: float


def moment_of_inertia(inertia, mass, radius):
    """Moment of inertia I = κ m R² of a disc, mass length²; numbers or arrays of one shape.

    inertia: κ, no unit, ½ for a uniform disc. mass: m. radius: R, length.
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
    impulse = -(1.0 + rotation.roughness) * slip / (a_mobility + b_mobility)
    a.vx += impulse / a.m * tx
    a.vy += impulse / a.m * ty
    b.vx -= impulse / b.m * tx
    b.vy -= impulse / b.m * ty
    rotation.omega[u] += a.r / rotation.inertia[u] * impulse
    rotation.omega[w] += b.r / rotation.inertia[w] * impulse


@inline
def tangential_impulse_at_wall(disc, own, nx, ny, rotation):
    """Apply the tangential impulse of a wall at rest to the velocity and spin of a disc that touches it."""
    u = np.uintp(own)
    tx = ny  # the wall is the second disc: n from the disc to the wall is -(nx, ny)
    ty = -nx
    slip = disc.vx * tx + disc.vy * ty + disc.r * rotation.omega[u]
    mobility = (nx * nx + ny * ny) / disc.m + disc.r * disc.r / rotation.inertia[u]
    impulse = -(1.0 + rotation.wall_roughness) * slip / mobility
    disc.vx += impulse / disc.m * tx
    disc.vy += impulse / disc.m * ty
    rotation.omega[u] += disc.r / rotation.inertia[u] * impulse
