"""Gravity: the same acceleration everywhere, so that discs fly along parabolas."""

from typing import NamedTuple

from idealgas._jit import inline


class Gravity(NamedTuple):
    """Constant acceleration, length/time²."""

    x: float
    y: float


@inline
def acceleration_along(gravity, along_y):
    """Component of the acceleration along an axis of the box."""
    if gravity is not None:
        return gravity.y if along_y else gravity.x
    return 0.0
