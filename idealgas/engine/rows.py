"""Writing events into a batch."""

import numpy as np

from idealgas._jit import inline
from idealgas.events import Kind

DISC = int(Kind.DISC)
WALL = int(Kind.WALL)


@inline
def write_row(batch, row, time, own, partner, kind, disc):
    """One disc's row: its state after the event."""
    u = np.uintp(row)
    batch.time[u] = time
    batch.disc[u] = own
    batch.partner[u] = partner
    batch.kind[u] = kind
    batch.position[u, 0] = disc.x
    batch.position[u, 1] = disc.y
    batch.velocity[u, 0] = disc.vx
    batch.velocity[u, 1] = disc.vy
