"""Writing events to a batch. Each function that writes a whole event returns the number of rows, 0 without a log."""

import numpy as np

from idealgas.columns import Kind
from idealgas.jit import inline, prefetch_next_line

DISC, WALL, WALL_END, PISTON, THERMOSTAT, _, ESCAPED, FIXED_DISC = (int(kind) for kind in Kind)
U = np.uintp
NO_END = 1 << 62  # number of rows that stands for no limit, without a log


@inline
def batch_capacity(batch):
    """Number of filled rows at which processing stops, because a pair needs two free rows."""
    if batch is not None:
        return batch.time.shape[0] - 1
    return NO_END


@inline
def write_event(batch, row, time, disc_id, partner, kind, disc, position, rotation, periodic):
    """Write the row of a disc in an event: its state after the event, in the columns that the batch has."""
    u = U(row)
    batch.time[u] = time
    batch.disc[u] = disc_id
    batch.partner[u] = partner
    batch.kind[u] = kind
    batch.velocity[u, 0] = disc.vx
    batch.velocity[u, 1] = disc.vy
    if position is not None:
        position[u, 0] = disc.x
        position[u, 1] = disc.y
    if rotation is not None:
        batch.angular_velocity[u] = rotation.omega[U(disc_id)]
    if periodic is not None:
        batch.image[u, 0] = periodic.image[U(disc_id), 0]
        batch.image[u, 1] = periodic.image[U(disc_id), 1]


@inline
def fetch_next_rows(batch, row, position, angular_velocity, image, trial):
    """Prefetch the memory of the next rows, so that the next pair is written faster."""
    prefetch_next_line(batch.time, row)
    prefetch_next_line(batch.disc, row)
    prefetch_next_line(batch.partner, row)
    prefetch_next_line(batch.kind, row)
    prefetch_next_line(batch.velocity, row)
    if position is not None:
        prefetch_next_line(position, row)
    if angular_velocity is not None:
        prefetch_next_line(angular_velocity, row)
    if image is not None:
        prefetch_next_line(image, row)
    if trial is not None:
        prefetch_next_line(trial, row)


@inline
def write_pair(batch, row, time, record, ids, i, j, effects):
    """Write both rows of a collision of discs i and j, the row of the smaller id first."""
    if batch is not None:
        fetch_next_rows(batch, U(row), batch.position, batch.angular_velocity, batch.image, batch.trial)
        a, b = (i, j) if ids[U(i)] < ids[U(j)] else (j, i)
        a_id = np.int64(ids[U(a)])
        b_id = np.int64(ids[U(b)])
        position, rotation, periodic = batch.position, effects.rotation, effects.periodic
        write_event(batch, row, time, a_id, b_id, DISC, record[U(a)], position, rotation, periodic)
        write_event(batch, row + 1, time, b_id, a_id, DISC, record[U(b)], position, rotation, periodic)
        return 2
    return 0


@inline
def write_trial(batch, row, trial):
    """Write the number of a Monte Carlo trial into both rows of a pair."""
    if batch is not None:
        batch.trial[U(row)] = trial
        batch.trial[U(row + 1)] = trial


@inline
def write_hit(batch, row, time, disc_id, partner, kind, disc, effects):
    """Write the row of an event that involves a single disc; partner: -1 - k for wall k, or BATH."""
    if batch is not None:
        rotation, periodic = effects.rotation, effects.periodic
        write_event(
            batch, row, time, np.int64(disc_id), np.int64(partner), kind, disc, batch.position, rotation, periodic
        )
        return 1
    return 0
