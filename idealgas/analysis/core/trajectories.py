"""Exact positions and velocities of some discs at many instants, from their events."""

import numpy as np

from idealgas.jit import njit, noinline
from idealgas.log import Log
from idealgas.physics.motion import position_after


def sample_trajectories(log: Log, times: np.ndarray, discs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions (length) and velocities (length/time) of M discs at G increasing times, each (G, M, 2).

    Positions are unwrapped along periodic axes. Flights must be straight lines, without gravity.
    """
    state = log.state_at(times[0])
    box = np.array(log.box)
    position = state.position if state.image is None else state.position + state.image * box
    slot = np.full(len(log.discs), -1)
    slot[discs] = np.arange(len(discs))
    tracks = np.column_stack((np.full(len(discs), times[0]), position[discs], state.velocity[discs]))
    reached = np.zeros(len(discs), np.int64)
    places, velocities = np.empty((2, len(times), len(discs), 2))
    columns = ("time", "disc", "position", "velocity", *(("image",) if state.image is not None else ()))
    for rows in log.chunks(columns, log.row_at(times[0], "right"), log.row_at(times[-1], "right")):
        place = rows.position + rows.image * box if state.image is not None else rows.position
        _follow(rows.time, rows.disc, place, rows.velocity, slot, tracks, reached, times, places, velocities)
    _finish(tracks, reached, times, places, velocities)
    return places, velocities


@njit
def _follow(time, disc, position, velocity, slot, tracks, reached, times, places, velocities):
    for row in range(time.shape[0]):
        k = slot[np.uintp(disc[row])]
        if k < 0:
            continue
        while reached[k] < times.shape[0] and times[reached[k]] < time[row]:
            _put(tracks[k], k, reached, times, places, velocities)
        tracks[k, 0] = time[row]
        for axis in range(2):
            tracks[k, 1 + axis] = position[row, axis]
            tracks[k, 3 + axis] = velocity[row, axis]


@njit
def _finish(tracks, reached, times, places, velocities):
    for k in range(tracks.shape[0]):
        while reached[k] < times.shape[0]:
            _put(tracks[k], k, reached, times, places, velocities)


@noinline
def _put(track, k, reached, times, places, velocities):
    g = reached[k]
    for axis in range(2):
        places[g, k, axis] = position_after(track[1 + axis], track[3 + axis], None, times[g] - track[0])
        velocities[g, k, axis] = track[3 + axis]
    reached[k] += 1
