"""Writing events into a batch; each function returns the number of rows it wrote, 0 where no log is kept."""

import numpy as np

from idealgas.columns import BATH, FIRST_SEGMENT, Kind
from idealgas.jit import inline, prefetch_next_line

DISC, WALL, WALL_END, PISTON, THERMOSTAT = (int(kind) for kind in Kind)
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
        column[row] = rotation.omega[np.uintp(own)]


@inline
def write_image(column, row, own, periodic):
    """Write a disc's image (box lengths along x and y) into a row, where sides are periodic."""
    if periodic is not None:
        column[row, 0] = periodic.image[np.uintp(own), 0]
        column[row, 1] = periodic.image[np.uintp(own), 1]


@inline
def write_event(batch, row, time, own, partner, kind, disc, effects):
    """Write one disc's row of an event: its state after the event."""
    u = np.uintp(row)
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
        fetch_next_rows(batch, np.uintp(row))
        a, b = (i, j) if ids[np.uintp(i)] < ids[np.uintp(j)] else (j, i)
        a_id = np.int64(ids[np.uintp(a)])
        b_id = np.int64(ids[np.uintp(b)])
        write_event(batch, row, time, a_id, b_id, DISC, record[np.uintp(a)], effects)
        write_event(batch, row + 1, time, b_id, a_id, DISC, record[np.uintp(b)], effects)
        return 2
    return 0


@inline
def write_trial(batch, row, trial):
    """Write the number of a Monte Carlo trial into both rows of a pair."""
    if batch is not None:
        batch.trial[np.uintp(row)] = trial
        batch.trial[np.uintp(row + 1)] = trial


@inline
def write_side_hit(batch, row, time, own, side, disc, effects):
    """Write the row of a disc that hit a side of the box."""
    if batch is not None:
        write_event(batch, row, time, np.int64(own), -1 - side, WALL, disc, effects)
        return 1
    return 0


@inline
def write_segment_hit(batch, row, time, own, segment, at_end, disc, effects):
    """Write the row of a disc that hit a wall segment."""
    if batch is not None:
        kind = WALL_END if at_end else WALL
        write_event(batch, row, time, np.int64(own), -1 - FIRST_SEGMENT - segment, kind, disc, effects)
        return 1
    return 0


@inline
def write_piston_hit(batch, row, time, own, piston, disc, effects):
    """Write the row of a disc that hit the piston."""
    if batch is not None and piston is not None:
        write_event(batch, row, time, np.int64(own), -1 - piston[0].side, PISTON, disc, effects)
        return 1
    return 0


@inline
def write_thermostat_collision(batch, row, time, own, disc, effects):
    """Write the row of a thermostat collision."""
    if batch is not None:
        write_event(batch, row, time, np.int64(own), BATH, THERMOSTAT, disc, effects)
        return 1
    return 0
