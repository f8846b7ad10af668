"""Gravity: a uniform acceleration, constant between the steps of its schedule, under which discs move on parabolas."""

from typing import NamedTuple

from idealgas.jit import inline


class Gravity(NamedTuple):
    """Current acceleration of the discs.

    Attributes:
        x: component along x, length/time².
        y: component along y, length/time².
    """

    x: float
    y: float


@inline
def acceleration_along(gravity, along_y):
    """Component of the acceleration along y or, if not along_y, along x, length/time²; 0 without gravity."""
    if gravity is not None:
        return gravity.y if along_y else gravity.x
    return 0.0


@inline
def potential_energy(mass, place, gravity):
    """Potential energy of a mass in gravity, mass length²/time²; 0 without gravity.

    place: unwrapped position (x, y), length.
    """
    if gravity is not None:
        return -(mass * (gravity.x * place[0] + gravity.y * place[1]))
    return 0.0
