"""Writing events into a batch; each function returns the number of rows it wrote, 0 where no log is kept."""

import numpy as np

from idealgas.columns import Kind
from idealgas.jit import inline, prefetch_next_line

DISC, WALL, WALL_END, PISTON, THERMOSTAT, _, ESCAPED, FIXED_DISC = (int(kind) for kind in Kind)
U = np.uintp
NO_END = 1 << 62  # rows, where no log is kept


@inline
def batch_capacity(batch):
    """Number of rows that may be full when an event is processed: a pair needs two more."""
    if batch is not None:
        return batch.time.shape[0] - 1
    return NO_END


@inline
def write_position(column, row, disc):
    """Write a disc's position (length) into a row, where the batch has positions."""
    if column is not None:
        column[row, 0] = disc.x
        column[row, 1] = disc.y


@inline
def write_spin(column, row, own, rotation):
    """Write a disc's angular velocity (1/time) into a row, where discs spin."""
    if rotation is not None:
        column[row] = rotation.omega[U(own)]


@inline
def write_image(column, row, own, periodic):
    """Write a disc's image (box lengths along x and y) into a row, where sides are periodic."""
    if periodic is not None:
        column[row, 0] = periodic.image[U(own), 0]
        column[row, 1] = periodic.image[U(own), 1]


@inline
def write_event(batch, row, time, own, partner, kind, disc, effects):
    """Write one disc's row of an event: its state after the event."""
    u = U(row)
    batch.time[u] = time
    batch.disc[u] = own
    batch.partner[u] = partner
    batch.kind[u] = kind
    write_position(batch.position, u, disc)
    batch.velocity[u, 0] = disc.vx
    batch.velocity[u, 1] = disc.vy
    write_spin(batch.angular_velocity, u, own, effects.rotation)
    write_image(batch.image, u, own, effects.periodic)


@inline
def fetch_column(column, row):
    """Prefetch the memory of a column's next rows, if the batch has the column."""
    if column is not None:
        prefetch_next_line(column, row)


@inline
def fetch_next_rows(batch, row):
    """Prefetch the memory of the next rows, so that the next pair is written sooner."""
    fetch_column(batch.time, row)
    fetch_column(batch.disc, row)
    fetch_column(batch.partner, row)
    fetch_column(batch.kind, row)
    fetch_column(batch.position, row)
    fetch_column(batch.velocity, row)
    fetch_column(batch.angular_velocity, row)
    fetch_column(batch.image, row)
    fetch_column(batch.trial, row)


@inline
def write_pair(batch, row, time, record, ids, i, j, effects):
    """Write both rows of a collision of discs i and j, that of the smaller id first."""
    if batch is not None:
        fetch_next_rows(batch, U(row))
        a, b = (i, j) if ids[U(i)] < ids[U(j)] else (j, i)
        a_id = np.int64(ids[U(a)])
        b_id = np.int64(ids[U(b)])
        write_event(batch, row, time, a_id, b_id, DISC, record[U(a)], effects)
        write_event(batch, row + 1, time, b_id, a_id, DISC, record[U(b)], effects)
        return 2
    return 0


@inline
def write_trial(batch, row, trial):
    """Write the number of a Monte Carlo trial into both rows of a pair."""
    if batch is not None:
        batch.trial[U(row)] = trial
        batch.trial[U(row + 1)] = trial


@inline
def write_hit(batch, row, time, own, partner, kind, disc, effects):
    """Write the row of an event of one disc; partner: -1 - k for wall k, or BATH."""
    if batch is not None:
        write_event(batch, row, time, np.int64(own), partner, kind, disc, effects)
        return 1
    return 0
