"""Free flight: r(t) = r₀ + v t."""

from idealgas._jit import inline


@inline
def advance(disc, time):
    """Move a disc's record to a later time."""
    dt = time - disc.t
    disc.x += disc.vx * dt
    disc.y += disc.vy * dt
    disc.t = time
