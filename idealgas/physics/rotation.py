"""Rough discs: the tangential impulse that couples motion and spin (rough-sphere model with a constant coefficient).

Chapman & Cowling, The Mathematical Theory of Non-Uniform Gases, 11.2; Brilliantov & Pöschel, Kinetic Theory of Granular
Gases, 2.2. Roughness 1 conserves energy, -1 is smooth.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas._jit import inline


class Rotation(NamedTuple):
    """omega: (N,) f8 by id, angular velocity. inertia: (N,) f8 by id.

    roughness, wall_roughness: coefficients of tangential restitution, from -1 (smooth) to 1 (perfectly rough).
    """

    omega: np.ndarray
    inertia: np.ndarray
    roughness: float
    wall_roughness: float


def moment_of_inertia(inertia, mass, radius):
    """Moment of inertia I = κ m R² of a disc; inertia: κ, ½ for a uniform disc. Numbers or arrays of one shape."""
    return inertia * mass * radius**2


@inline
def tangential_impulse(a, b, a_id, b_id, x, y, rotation):
    """The tangential impulse of two touching discs; (x, y): position of a relative to b."""
    u = np.uintp(a_id)
    w = np.uintp(b_id)
    distance = math.sqrt(x * x + y * y)
    tx = y / distance  # t = z × n with n = -(x, y)/distance, from a to b
    ty = -x / distance
    slip = (a.vx - b.vx) * tx + (a.vy - b.vy) * ty + (a.r * rotation.omega[u] + b.r * rotation.omega[w])
    a_give = 1.0 / a.m + a.r * a.r / rotation.inertia[u]
    b_give = 1.0 / b.m + b.r * b.r / rotation.inertia[w]
    impulse = -(1.0 + rotation.roughness) * slip / (a_give + b_give)
    a.vx += impulse / a.m * tx
    a.vy += impulse / a.m * ty
    b.vx -= impulse / b.m * tx
    b.vy -= impulse / b.m * ty
    rotation.omega[u] += a.r / rotation.inertia[u] * impulse
    rotation.omega[w] += b.r / rotation.inertia[w] * impulse


@inline
def tangential_impulse_at_wall(disc, own, nx, ny, rotation):
    """The tangential impulse at a wall with unit normal (nx, ny) towards the disc that does not slide along itself."""
    u = np.uintp(own)
    tx = ny  # the wall is the second disc: n from the disc to the wall is -(nx, ny)
    ty = -nx
    slip = disc.vx * tx + disc.vy * ty + disc.r * rotation.omega[u]
    give = (nx * nx + ny * ny) / disc.m + disc.r * disc.r / rotation.inertia[u]
    impulse = -(1.0 + rotation.wall_roughness) * slip / give
    disc.vx += impulse / disc.m * tx
    disc.vy += impulse / disc.m * ty
    rotation.omega[u] += disc.r / rotation.inertia[u] * impulse
