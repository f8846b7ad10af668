"""Speed, velocity components and kinetic energy during a fall: values, times at which these are reached, integrals.

A fall starts at velocity (vx, vy), length/time, under a constant acceleration `gravity`, length/time². Quantities are
numbered as in `flights.VELOCITY_QUANTITIES`: speed, vx, vy, and kinetic energy. All arguments except `quantity` and
`gravity` may be arrays (n,).
"""

import numpy as np

from idealgas.physics.motion import path_length, velocity_after

SPEED, ALONG_X, ALONG_Y = range(3)

Gravity = tuple[float, float]


def velocity_quantity(quantity: int, mass: np.ndarray, vx: np.ndarray, vy: np.ndarray) -> np.ndarray:
    """Return the value of a quantity at a velocity."""
    if quantity == SPEED:
        return np.sqrt(vx * vx + vy * vy)
    if quantity == ALONG_X:
        return vx
    if quantity == ALONG_Y:
        return vy
    return 0.5 * mass * (vx * vx + vy * vy)


def value_during_flight(
    quantity: int, mass: np.ndarray, vx: np.ndarray, vy: np.ndarray, gravity: Gravity, time: np.ndarray
) -> np.ndarray:
    """Return the value of a quantity at a time after the start of a fall."""
    return velocity_quantity(quantity, mass, velocity_after(vx, gravity[0], time), velocity_after(vy, gravity[1], time))


def changes_during_flight(quantity: int, gravity: Gravity) -> bool:
    """Return whether a quantity changes during a fall; a velocity component without acceleration does not."""
    if quantity in (ALONG_X, ALONG_Y):
        return gravity[quantity - ALONG_X] != 0.0
    return any(gravity)


def turning_time(quantity: int, vx: np.ndarray, vy: np.ndarray, gravity: Gravity) -> np.ndarray:
    """Return the time at which a quantity is smallest, possibly before the start of a fall; inf for vx and vy."""
    if quantity in (ALONG_X, ALONG_Y):
        return np.full_like(vx, np.inf)
    return -(vx * gravity[0] + vy * gravity[1]) / (gravity[0] ** 2 + gravity[1] ** 2)


def time_at_value(
    quantity: int,
    mass: np.ndarray,
    value: np.ndarray,
    rises: np.ndarray,
    vx: np.ndarray,
    vy: np.ndarray,
    gravity: Gravity,
) -> np.ndarray:
    """Return the time at which a quantity reaches a value, after its minimum if `rises` is true, otherwise before."""
    if quantity == ALONG_X:
        return (value - vx) / gravity[0]
    if quantity == ALONG_Y:
        return (value - vy) / gravity[1]
    square = value * value if quantity == SPEED else 2.0 * value / mass
    a = gravity[0] ** 2 + gravity[1] ** 2
    across = (
        vx * gravity[1] - vy * gravity[0]
    )  # the constant velocity component perpendicular to the acceleration, times √a
    apart = np.sqrt(np.maximum(square - across * across / a, 0.0) / a)
    return turning_time(quantity, vx, vy, gravity) + np.where(rises, apart, -apart)


def integral_over_fall(
    quantity: int, mass: np.ndarray, vx: np.ndarray, vy: np.ndarray, gravity: Gravity, time: np.ndarray
) -> np.ndarray:
    """Return the integral of a quantity over time during a fall of duration `time`."""
    if quantity == SPEED:
        return path_length(vx, vy, gravity, time)
    if quantity == ALONG_X:
        return time * (vx + 0.5 * gravity[0] * time)
    if quantity == ALONG_Y:
        return time * (vy + 0.5 * gravity[1] * time)
    a, b, c = gravity[0] ** 2 + gravity[1] ** 2, vx * gravity[0] + vy * gravity[1], vx * vx + vy * vy
    return 0.5 * mass * time * (c + time * (b + time * a / 3.0))
