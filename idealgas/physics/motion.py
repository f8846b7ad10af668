"""Free flight: r(t) = r₀ + v t, and under gravity + ½ g t²."""

from idealgas._jit import inline


@inline
def advance(disc, time, gravity):
    """Move a disc's record to a later time."""
    dt = time - disc.t
    disc.x += disc.vx * dt
    disc.y += disc.vy * dt
    if gravity is not None:
        disc.x += 0.5 * gravity.x * dt * dt
        disc.y += 0.5 * gravity.y * dt * dt
        disc.vx += gravity.x * dt
        disc.vy += gravity.y * dt
    disc.t = time
