"""Tangent map of a gas: how small deviations of positions and velocities grow in flights and collisions.

The method follows Dellago, Posch & Hoover, Phys. Rev. E 53, 1485 (1996), extended to walls under gravity. An array (N,
4, K) contains K deviations, each with components δx, δy (length), δvx, δvy (length/time) for every disc. The shift in
the time of a collision is taken into account to first order.
"""

import math

from idealgas.jit import inline


@inline
def fly(deviations, i, delay):
    """Propagate the deviations of disc i through a free flight of duration `delay` (time), with or without gravity."""
    for k in range(deviations.shape[2]):
        deviations[i, 0, k] += deviations[i, 2, k] * delay
        deviations[i, 1, k] += deviations[i, 3, k] * delay


@inline
def collide_smooth(deviations, i, j, masses, x, y, vx, vy):
    """Propagate the deviations through an elastic collision of two smooth discs i and j.

    masses: (N,). x, y: position of disc i relative to disc j at contact, length. vx, vy: velocity of disc i relative to
    disc j before the collision, length/time.
    """
    distance = math.sqrt(x * x + y * y)
    nx, ny = x / distance, y / distance
    approach = vx * nx + vy * ny
    to_i = 2.0 * masses[j] / (masses[i] + masses[j])
    to_j = 2.0 * masses[i] / (masses[i] + masses[j])
    for k in range(deviations.shape[2]):
        dx, dy = deviations[i, 0, k] - deviations[j, 0, k], deviations[i, 1, k] - deviations[j, 1, k]
        dvx, dvy = deviations[i, 2, k] - deviations[j, 2, k], deviations[i, 3, k] - deviations[j, 3, k]
        delay = -(nx * dx + ny * dy) / approach
        dnx, dny = (dx + vx * delay) / distance, (dy + vy * delay) / distance
        change = dvx * nx + dvy * ny + vx * dnx + vy * dny
        wx, wy = change * nx + approach * dnx, change * ny + approach * dny
        shift = approach * delay
        deviations[i, 0, k] += to_i * shift * nx
        deviations[i, 1, k] += to_i * shift * ny
        deviations[i, 2, k] -= to_i * wx
        deviations[i, 3, k] -= to_i * wy
        deviations[j, 0, k] -= to_j * shift * nx
        deviations[j, 1, k] -= to_j * shift * ny
        deviations[j, 2, k] += to_j * wx
        deviations[j, 3, k] += to_j * wy


@inline
def reflect(deviations, i, axis, velocity, gravity):
    """Propagate the deviations through an elastic reflection of disc i at a side of the box.

    axis: axis of the normal, 0 or 1. velocity: velocity along this axis before the reflection, length/time. gravity:
    acceleration along this axis, length/time².
    """
    for k in range(deviations.shape[2]):
        delay = -deviations[i, axis, k] / velocity
        deviations[i, axis, k] = -deviations[i, axis, k]
        deviations[i, 2 + axis, k] = -deviations[i, 2 + axis, k] - 2.0 * gravity * delay
