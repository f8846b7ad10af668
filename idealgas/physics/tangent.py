"""Tangent map of a gas: how small deviations of positions and velocities grow in flights and collisions.

The method follows Dellago, Posch & Hoover, Phys. Rev. E 53, 1485 (1996), extended to gravity and to walls that are
curved or move. An array (M, 4, K) contains K deviations, each with components δx, δy (length), δvx, δvy (length/time)
for every body. The bodies are the discs, the pistons of finite mass, and a body at rest without deviations, which
stands for all other walls. The shift in the time of a collision is taken into account to first order.
"""

from idealgas.jit import inline


@inline
def fly(deviations, i, delay):
    """Propagate the deviations of body i through a free flight of duration `delay` (time), with or without gravity."""
    for k in range(deviations.shape[2]):
        deviations[i, 0, k] += deviations[i, 2, k] * delay
        deviations[i, 1, k] += deviations[i, 3, k] * delay


@inline
def collide(deviations, i, j, share_i, share_j, normal, curvature, velocity, pull):
    """Propagate the deviations through a collision of two smooth bodies i and j, which changes u·n to -e u·n.

    The bodies touch when their distance along the unit normal n vanishes; n depends only on the position of i relative
    to j. The normal velocity of i changes by -share_i u·n and that of j by +share_j u·n.

    share_i, share_j: (1 + e) μ/m of each body, where μ is the reduced mass and e is 1 in an elastic collision; 0 for a
    body of infinite mass. normal: (x, y), unit normal n of either sign. curvature: 1/length, derivative of n with
    respect to tangential displacements; 0 for a flat wall, and 1/distance if n is the direction from a centre to i.
    velocity: (x, y), velocity u of i relative to j before the collision, length/time. pull: component along n of the
    acceleration of i relative to j, length/time².
    """
    nx, ny, vx, vy = normal[0], normal[1], velocity[0], velocity[1]
    approach = vx * nx + vy * ny
    for k in range(deviations.shape[2]):
        dx, dy = deviations[i, 0, k] - deviations[j, 0, k], deviations[i, 1, k] - deviations[j, 1, k]
        dvx, dvy = deviations[i, 2, k] - deviations[j, 2, k], deviations[i, 3, k] - deviations[j, 3, k]
        shift = -(nx * dx + ny * dy)
        delay = shift / approach
        dnx, dny = curvature * (dx + vx * delay), curvature * (dy + vy * delay)
        change = dvx * nx + dvy * ny + vx * dnx + vy * dny + pull * delay
        wx, wy = change * nx + approach * dnx, change * ny + approach * dny
        deviations[i, 0, k] += share_i * shift * nx
        deviations[i, 1, k] += share_i * shift * ny
        deviations[i, 2, k] -= share_i * wx
        deviations[i, 3, k] -= share_i * wy
        deviations[j, 0, k] -= share_j * shift * nx
        deviations[j, 1, k] -= share_j * shift * ny
        deviations[j, 2, k] += share_j * wx
        deviations[j, 3, k] += share_j * wy
