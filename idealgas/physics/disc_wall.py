"""Contact of a disc with a side of the box (left 0, right 1, bottom 2, top 3), and its collision with any wall at rest.

Without gravity, contact times can be computed in any precision, see `arithmetic`. In all functions, (nx, ny) is the
unit normal of the wall, which points towards the disc.
"""

from idealgas.jit import inline
from idealgas.physics.arithmetic import changed, correction, number
from idealgas.physics.gravity import acceleration_along
from idealgas.physics.motion import NEVER, time_to_plane
from idealgas.physics.restitution import wall_restitution_factor
from idealgas.physics.rotation import tangential_impulse_at_wall
from idealgas.physics.thermal import emit, is_thermal


@inline
def arrival_delay(position, velocity, target):
    """Time until a coordinate changing at constant velocity reaches a target ahead of it; NEVER if the velocity is 0.

    position, target: length. velocity: length/time, directed towards the target. The delay is 0 if the coordinate is at
    the target or, because of rounding, beyond it.
    """
    zero = number(0.0, velocity)
    delay = max((target - position) / velocity, zero)
    return number(NEVER, velocity) if velocity == zero else delay


@inline
def inward_normal(side):
    """Unit normal (x, y) of a side of the box, pointing into the box."""
    sign = -1.0 if side & 1 else 1.0
    return (sign, 0.0) if side < 2 else (0.0, sign)


@inline
def side_contact(disc, side, length, gravity):
    """Local time at which a disc touches a side of the box; NEVER if it does not.

    side: 0 to 3. length: distance between this side and the opposite side, length.
    """
    low, high = disc.r, length - disc.r
    position, velocity = (disc.x, disc.vx) if side < 2 else (disc.y, disc.vy)
    upper = side & 1
    zero, never = number(0.0, velocity), number(NEVER, velocity)
    if gravity is not None:
        pull = acceleration_along(gravity, side >= 2)
        if upper:
            delay = time_to_plane(high - position, -velocity, -pull)
        else:
            delay = time_to_plane(position - low, velocity, pull)
    elif upper:
        delay = arrival_delay(position, velocity, high) if velocity > zero else never
    else:
        delay = arrival_delay(position, velocity, low) if velocity < zero else never
    return disc.t + delay if delay < never else never


@inline
def reflected_velocity(disc, disc_id, nx, ny, restitution):
    """Velocity (vx, vy) of a disc after the normal impulse of a wall at rest, length/time.

    The result does not rely on (nx, ny) having exactly unit length, because rounding changes this length.
    """
    factor = wall_restitution_factor(restitution, disc_id, disc.t)
    k = factor * (disc.vx * nx + disc.vy * ny) / (nx * nx + ny * ny)
    dx, dy = -k * nx, -k * ny
    c = correction((factor * disc.vx + dx) * dx + (factor * disc.vy + dy) * dy, dx * dx + dy * dy)
    return changed(disc.vx, dx, c), changed(disc.vy, dy, c)


@inline
def collide_with_wall(disc, disc_id, nx, ny, wall, restitution, rotation, thermal):
    """Change the velocity and spin of a disc that hits a wall at rest.

    wall: number of the wall.
    """
    if thermal is not None and is_thermal(thermal, wall):
        emit(disc, disc_id, nx, ny, wall, thermal, rotation)
        return
    if rotation is not None:
        tangential_impulse_at_wall(disc, disc_id, nx, ny, rotation)
    disc.vx, disc.vy = reflected_velocity(disc, disc_id, nx, ny, restitution)
