"""Free flight, r(t) = r₀ + v t or, with gravity, r₀ + v t + ½ g t², and the time until a body reaches a plane."""

import math

import numpy as np

from idealgas.jit import inline

NEVER = 1e300
"""Time of an event that never happens: later than all events, but finite, so that sums and comparisons remain valid."""

MAX_DISPLACEMENT = 6144
"""Longest path of the fastest disc in an epoch, in diameters of the smallest disc.

If 4 events per disc take longer, the epoch lasts until they have happened. For each of the two discs, rounding of the
clock adds at most 2⁻⁵⁴ of this path to the error of a contact. A few discs in a wide box have longer epochs, of about
500 events in total; if the path is 500 box lengths L, rounding of the clock adds about 2⁻⁴⁵ L.
"""


@inline
def position_after(position, velocity, acceleration, delay):
    """Coordinate (length) after a delay (time) in free flight, x + v t + ½ a t²; numbers or arrays.

    acceleration: length/time², or None without gravity. The terms are always summed from left to right, so that the
    engine, the replay and the analyses obtain the same result to the last bit.
    """
    if acceleration is not None:
        return position + velocity * delay + 0.5 * acceleration * delay * delay
    return position + velocity * delay


@inline
def velocity_after(velocity, acceleration, delay):
    """Component of the velocity (length/time) after a delay (time) in free flight, v + a t; numbers or arrays."""
    return velocity + acceleration * delay


def path_length(
    vx: np.ndarray, vy: np.ndarray, gravity: np.ndarray | tuple[float, float] | None, delay: np.ndarray
) -> np.ndarray:
    """Path lengths (n,) of free flights, ∫ |v| dt.

    On a parabola, let u be the component of the velocity along gravity, w the component perpendicular to gravity, and s
    = √(u² + w²). The path length is ∫ s du/g, with antiderivative (u s + w² asinh(u/w))/2g. The difference between the
    values at the two ends is rearranged so that no digits cancel.

    Args:
        vx: (n,) velocity along x at the start, length/time.
        vy: (n,) velocity along y at the start, length/time.
        gravity: components along x and y, numbers or arrays (n,), length/time²; None without gravity.
        delay: (n,) durations, time.
    """
    if gravity is None:
        return np.asarray(np.hypot(vx, vy) * delay)
    gx, gy = np.broadcast_to(gravity[0], vx.shape), np.broadcast_to(gravity[1], vx.shape)
    g = np.hypot(gx, gy)
    falls, unit = g > 0.0, np.where(g > 0.0, g, 1.0)
    first = (vx * gx + vy * gy) / unit
    across = np.where(falls, (vx * gy - vy * gx) / unit, np.hypot(vx, vy))
    last, square = first + g * delay, across * across
    begin, end, middle = np.hypot(first, across), np.hypot(last, across), 0.5 * (first + last)
    both = begin + end
    with np.errstate(divide="ignore", invalid="ignore"):
        turned = (last * begin - first * end) / square
        steady = 2.0 * middle * g * delay / (last * begin + first * end)
        bent = square * np.arcsinh(np.where(first * last > 0.0, steady, turned)) / g
        steep = delay * (0.5 * both + 2.0 * middle * middle / both)
    flat = square / np.where(begin > 0.0, begin, 1.0) * delay  # the limit of zero gravity
    return np.asarray(0.5 * (np.where(both > 0.0, steep, 0.0) + np.where(falls & (square > 0.0), bent, flat)))


@inline
def advance(disc, time, gravity):
    """Move a disc in free flight to a later local time."""
    delay = time - disc.t
    if gravity is not None:
        disc.x = position_after(disc.x, disc.vx, gravity.x, delay)
        disc.y = position_after(disc.y, disc.vy, gravity.y, delay)
        disc.vx = velocity_after(disc.vx, gravity.x, delay)
        disc.vy = velocity_after(disc.vy, gravity.y, delay)
    else:
        disc.x = position_after(disc.x, disc.vx, None, delay)
        disc.y = position_after(disc.y, disc.vy, None, delay)
    disc.t = time


@inline
def time_to_plane(height, velocity, acceleration):
    """Time until height + velocity t + ½ acceleration t² is at or below zero and falling; NEVER if that never happens.

    height: length. velocity: length/time. acceleration: length/time². The time is 0 for a falling body at or below
    zero. A rising body that is below zero because of rounding arrives when it falls back through zero or, if it does
    not rise to zero, when it begins to fall. Rounding therefore cannot make a body sink.
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
def time_after(now, delay):
    """Time now + delay, rounded up to a time later than now if the delay is positive.

    Otherwise a body that turns back at the border of a cell could cross the border back and forth forever.
    """
    time = now + delay
    return np.nextafter(now, np.inf) if (time == now) & (delay > 0.0) else time


@inline
def stays_above(height, velocity, acceleration, delay):
    """Whether it is certain that height + velocity t + ½ acceleration t² is above zero until a delay (time) has passed.

    Only the beginning and the end are checked. A body that is accelerated upwards may be below zero in between, and the
    result for it is always False.
    """
    return (height > 0.0) & (acceleration <= 0.0) & (position_after(height, velocity, acceleration, delay) > 0.0)
