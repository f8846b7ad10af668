"""What any wall does to a disc that touches it: reflect, inelastically or roughly, or emit it anew at a temperature."""

from idealgas._jit import inline
from idealgas.physics.restitution import wall_rebound
from idealgas.physics.rotation import tangential_impulse_at_wall
from idealgas.physics.thermal import emit, is_thermal


@inline
def reflection_factor(disc, own, nx, ny, restitution):
    """What times (nx, ny) a disc's velocity loses at a wall; exact though the normal is a unit to rounding only."""
    speed = disc.vx * nx + disc.vy * ny
    return wall_rebound(restitution, own, disc.t) * speed / (nx * nx + ny * ny)


@inline
def collide_with_wall(disc, own, nx, ny, wall, restitution, rotation, thermal):
    """Change a disc's velocity at wall number `wall`, which is at rest; (nx, ny): its unit normal towards the disc."""
    if is_thermal(thermal, wall):
        emit(disc, own, nx, ny, wall, thermal, rotation)
        return
    if rotation is not None:
        tangential_impulse_at_wall(disc, own, nx, ny, rotation)
    k = reflection_factor(disc, own, nx, ny, restitution)
    disc.vx -= k * nx
    disc.vy -= k * ny
