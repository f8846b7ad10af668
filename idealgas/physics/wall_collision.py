"""What any wall does to a disc that touches it: reflect, inelastically or roughly, or emit it anew at a temperature."""

from idealgas._jit import inline
from idealgas.physics.restitution import wall_rebound
from idealgas.physics.rotation import tangential_impulse_at_wall
from idealgas.physics.thermal import emit, is_thermal


@inline
def collide_with_wall(disc, own, nx, ny, wall, restitution, rotation, thermal):
    """Change a disc's velocity at wall number `wall`, which is at rest; (nx, ny): its unit normal towards the disc."""
    if is_thermal(thermal, wall):
        emit(disc, own, nx, ny, wall, thermal, rotation)
        return
    if rotation is not None:
        tangential_impulse_at_wall(disc, own, nx, ny, rotation)
    speed = disc.vx * nx + disc.vy * ny
    k = (
        wall_rebound(restitution, own, disc.t) * speed / (nx * nx + ny * ny)
    )  # exact though n is a unit to rounding only
    disc.vx -= k * nx
    disc.vy -= k * ny
