"""Time reversal: the state from which a gas retraces its path, if its motion is reversible."""

from typing import TypeVar

import numpy as np

Velocity = TypeVar("Velocity", float, np.ndarray)


def reversed_velocity(velocity: Velocity) -> Velocity:
    """Velocity, or angular velocity, of the reversed motion; 0 does not become -0."""
    return 0.0 - velocity
