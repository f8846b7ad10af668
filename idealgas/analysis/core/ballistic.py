"""Velocity quantities along a fall at constant acceleration: values, times at which they are met, and integrals.

A fall starts at velocity (vx, vy), length/time, under the acceleration `gravity`, length/time². Quantities are numbered
as in `flights.VELOCITY_QUANTITIES`: speed, vx, vy, and kinetic energy.
"""

import math

from idealgas.jit import inline
from idealgas.physics.motion import NEVER, velocity_after

SPEED, ALONG_X, ALONG_Y = range(3)


@inline
def velocity_quantity(quantity, mass, vx, vy):
    """Value of a quantity at a velocity."""
    if quantity == SPEED:
        return math.sqrt(vx * vx + vy * vy)
    if quantity == ALONG_X:
        return vx
    if quantity == ALONG_Y:
        return vy
    return 0.5 * mass * (vx * vx + vy * vy)


@inline
def value_in_fall(quantity, mass, vx, vy, gravity, time):
    """Value of a quantity at a time after the start of a fall."""
    return velocity_quantity(quantity, mass, velocity_after(vx, gravity[0], time), velocity_after(vy, gravity[1], time))


@inline
def changes_in_fall(quantity, gravity):
    """Whether a quantity changes in a fall: a component of the velocity does not across the acceleration."""
    if quantity == ALONG_X:
        return gravity[0] != 0.0
    if quantity == ALONG_Y:
        return gravity[1] != 0.0
    return gravity[0] != 0.0 or gravity[1] != 0.0


@inline
def turning_time(quantity, vx, vy, gravity):
    """Time at which a quantity is least in a fall, maybe before its start; NEVER if it rises or falls all the time."""
    if quantity in (ALONG_X, ALONG_Y):
        return NEVER
    return -(vx * gravity[0] + vy * gravity[1]) / (gravity[0] ** 2 + gravity[1] ** 2)


@inline
def time_at_value(quantity, mass, value, rises, vx, vy, gravity):
    """Time in a fall at which a quantity has a value, after its least value if `rises`, else before it."""
    if quantity == ALONG_X:
        return (value - vx) / gravity[0]
    if quantity == ALONG_Y:
        return (value - vy) / gravity[1]
    square = value * value if quantity == SPEED else 2.0 * value / mass
    a = gravity[0] ** 2 + gravity[1] ** 2
    across = vx * gravity[1] - vy * gravity[0]  # of the velocity, times √a: what the fall leaves as it is
    way = math.sqrt(max(square - across * across / a, 0.0) / a)
    return turning_time(quantity, vx, vy, gravity) + (way if rises else -way)


@inline
def integral_over_fall(quantity, mass, vx, vy, gravity, time):
    """Integral of a quantity over a fall of a duration."""
    if quantity == SPEED:
        return length_of_fall(vx, vy, gravity, time)
    if quantity == ALONG_X:
        return time * (vx + 0.5 * gravity[0] * time)
    if quantity == ALONG_Y:
        return time * (vy + 0.5 * gravity[1] * time)
    a, b, c = gravity[0] ** 2 + gravity[1] ** 2, vx * gravity[0] + vy * gravity[1], vx * vx + vy * vy
    return 0.5 * mass * time * (c + time * (b + time * a / 3.0))


@inline
def length_of_fall(vx, vy, gravity, time):
    """Length of the path of a fall of a duration, length."""
    a, b = gravity[0] ** 2 + gravity[1] ** 2, vx * gravity[0] + vy * gravity[1]  # v² = a s² + 2 b s + v₀²
    across = abs(vx * gravity[1] - vy * gravity[0]) / a
    return math.sqrt(a) * (_half_arc(time + b / a, across) - _half_arc(b / a, across))


@inline
def length_of_flight(vx, vy, gravity, time):
    """Length of the path of a flight of a duration, with or without acceleration, length."""
    if gravity[0] != 0.0 or gravity[1] != 0.0:
        return length_of_fall(vx, vy, gravity, time)
    return math.sqrt(vx**2 + vy**2) * time


@inline
def _half_arc(u, k):
    """Integral ∫₀ᵘ √(s² + k²) ds."""
    root = math.sqrt(u * u + k * k)
    return 0.5 * (u * root + (k * k * math.asinh(u / k) if k > 0.0 else 0.0))
