"""Motion along one line under constant acceleration: when a height is reached from above."""

import math

from idealgas._jit import inline
from idealgas.physics.constants import NEVER


@inline
def time_to_plane(height, velocity, acceleration):
    """Delay until height + velocity t + ½ acceleration t² is at or below zero and falling; NEVER if it is not to be.

    A body that is at or below zero and falling lands now. One that rounding put below zero and that rises lands when it
    falls back through zero, or when it turns if it never gets that far: so it cannot sink.
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
