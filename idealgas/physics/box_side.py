"""A disc and the reflecting sides of the box: left 0, right 1, bottom 2, top 3."""

from idealgas._jit import inline
from idealgas.physics.constants import NEVER


@inline
def arrival_delay(position, velocity, target):
    """Time until a coordinate reaches the target it moves to; none if it is there or, by rounding, beyond."""
    delay = max((target - position) / velocity, 0.0)
    return NEVER if velocity == 0.0 else delay


@inline
def centre_range(length, radius):
    """Where a disc's centre may be between two opposite sides."""
    return radius, length - radius


@inline
def reflect(disc, side):
    """Turn the velocity component normal to a side."""
    if side < 2:
        disc.vx = -disc.vx
    else:
        disc.vy = -disc.vy
