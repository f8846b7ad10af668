"""Motion along one axis under constant acceleration: the time at which a body falls to a plane."""

import math

from idealgas.jit import inline
from idealgas.physics.motion import NEVER, position_after


@inline
def time_to_plane(height, velocity, acceleration):
    """Time until height + velocity t + ½ acceleration t² is at or below zero and falling; NEVER if it never is.

    height: length. velocity: length/time. acceleration: length/time². The time is 0 for a falling body at or below
    zero. A rising body that rounding put below zero counts when it falls back through zero or, if it never rises that
    far, when it begins to fall: so it cannot sink.
    """
    discriminant = velocity * velocity - 2.0 * acceleration * height
    root = math.sqrt(max(discriminant, 0.0))
    if velocity < 0.0:
        if height <= 0.0:
            return 0.0
        return 2.0 * height / (root - velocity) if discriminant >= 0.0 else NEVER
    if acceleration < 0.0:
        return (velocity + root) / -acceleration
    return NEVER


@inline
def stays_above(height, velocity, acceleration, delay):
    """Whether height + velocity t + ½ acceleration t² is above zero from 0 up to a delay (time).

    Only the two ends are asked, so it is also False for a body that is pulled up, which may have been below in between.
    """
    return (height > 0.0) & (acceleration <= 0.0) & (position_after(height, velocity, acceleration, delay) > 0.0)
