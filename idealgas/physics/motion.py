"""Free flight: r(t) = r₀ + v t, and with gravity r(t) = r₀ + v t + ½ g t²."""

from idealgas.jit import inline

NEVER = 1e300
"""Time of an event that does not happen: after all events, but finite, so that sums and comparisons stay ordinary."""


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
