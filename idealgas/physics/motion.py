"""Free flight: r(t) = r₀ + v t, and with gravity r(t) = r₀ + v t + ½ g t²; and the time of a fall to a plane."""

import math

import numpy as np

from idealgas.jit import inline

NEVER = 1e300
"""Time of an event that does not happen: after all events, but finite, so that sums and comparisons stay ordinary."""

MAX_DISPLACEMENT = 6144
"""Longest path of the fastest disc in an epoch, in diameters of the smallest one, unless 4 events per disc take longer.

The clock then adds at most 2⁻⁵⁴ of it per disc to the error of a contact. Few discs in a wide box have longer epochs,
of some 500 events in all: with as many crossings of the box L, the clock adds about 2⁻⁴⁵ L.
"""


@inline
def position_after(position, velocity, acceleration, delay):
    """Coordinate (length) after a delay (time) in free flight, x + v t + ½ a t²; numbers or arrays.

    acceleration: length/time², or None without gravity. The terms are summed from left to right: engine, replay and
    analyses agree to the last bit.
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
    """Length (n,) of the paths of free flights, ∫ |v| dt.

    vx, vy: (n,), length/time, velocity at the start. gravity: components along x and y, length/time², numbers or
    arrays (n,); None without gravity. delay: (n,), duration, time.

    On a parabola, with u the component of the velocity along gravity, w the one across and s = √(u² + w²), the integral
    of s du/g is (u s + w² asinh(u/w))/2g. Its values at both ends are subtracted before anything is rounded.
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
    flat = square / np.where(begin > 0.0, begin, 1.0) * delay  # the limit of no gravity
    return np.asarray(0.5 * (np.where(both > 0.0, steep, 0.0) + np.where(falls & (square > 0.0), bent, flat)))


@inline
def advance(disc, time, gravity):
    """Move a disc's record in free flight to a later local time."""
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
def time_after(now, delay):
    """Time (now plus a delay), later than now for any delay above zero, even one that rounding would take away.

    Otherwise a body that turns back on the border of a cell would cross it back and forth indefinitely.
    """
    time = now + delay
    return np.nextafter(now, np.inf) if (time == now) & (delay > 0.0) else time


@inline
def stays_above(height, velocity, acceleration, delay):
    """Whether height + velocity t + ½ acceleration t² is above zero from 0 up to a delay (time).

    It checks both ends only, so it is also False for a body accelerated upwards, which may be below in between.
    """
    return (height > 0.0) & (acceleration <= 0.0) & (position_after(height, velocity, acceleration, delay) > 0.0)
