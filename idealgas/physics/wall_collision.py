"""Collision of a disc with any wall: a reflection, inelastic or rough, or an emission at the wall's temperature."""

from idealgas.jit import inline
from idealgas.physics.restitution import wall_restitution_factor
from idealgas.physics.rotation import tangential_impulse_at_wall
from idealgas.physics.thermal import emit, is_thermal


@inline
def reflection_factor(disc, own, nx, ny, restitution):
    """Multiple of (nx, ny) that a reflection subtracts from a disc's velocity, length/time.

    It is exact although (nx, ny) has unit length only up to rounding.
    """
    speed = disc.vx * nx + disc.vy * ny
    return wall_restitution_factor(restitution, own, disc.t) * speed / (nx * nx + ny * ny)


@inline
def collide_with_wall(disc, own, nx, ny, wall, restitution, rotation, thermal):
    """Change the velocity and spin of a disc that touches a wall at rest.

    nx, ny: unit normal of the wall towards the disc. wall: number of the wall.
    """
    if is_thermal(thermal, wall):
        emit(disc, own, nx, ny, wall, thermal, rotation)
        return
    if rotation is not None:
        tangential_impulse_at_wall(disc, own, nx, ny, rotation)
    k = reflection_factor(disc, own, nx, ny, restitution)
    disc.vx -= k * nx
    disc.vy -= k * ny
