"""Free flight: r(t) = r₀ + v t, and under gravity + ½ g t²."""

from idealgas._jit import inline


@inline
def position_after(position, velocity, acceleration, delay):
    """Coordinate after a delay in free flight, x + v t + ½ a t²; acceleration: None without gravity.

    Numbers or arrays. Summed from left to right: engine, replay and analyses agree to the last bit.
    """
    if acceleration is not None:
        return position + velocity * delay + 0.5 * acceleration * delay * delay
    return position + velocity * delay


@inline
def velocity_after(velocity, acceleration, delay):
    """Component of the velocity after a delay in free flight, v + a t. Numbers or arrays."""
    return velocity + acceleration * delay


@inline
def advance(disc, time, gravity):
    """Move a disc's record to a later time."""
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
