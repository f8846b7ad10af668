"""Exact positions and velocities of some discs at many instants, from their flights."""

import numpy as np

from idealgas.log import Log
from idealgas.log.flights import NO_EVENT


def sample_trajectories(log: Log, times: np.ndarray, discs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions (length) and velocities (length/time) of M discs at G times in order, each (G, M, 2).

    Positions are unwrapped along periodic axes.
    """
    instants, back = np.unique(times, return_inverse=True)
    edges = np.append(instants, instants[-1]) if len(instants) == 1 else instants
    slot = np.full(len(log.discs), -1)
    slot[discs] = np.arange(len(discs))
    places, velocities = np.empty((2, len(edges), len(discs), 2))
    columns = ["disc", "block", "start", "velocity", "position", "displacement", "end_velocity", "kind"]
    if any(log.periodic):
        columns.append("image")
    for flights in log.flights(edges, discs=discs, columns=columns):
        assert flights.position is not None
        place = flights.position if flights.image is None else flights.position + flights.image * np.array(log.box)
        begun = np.flatnonzero(flights.start == edges.take(flights.block))
        at = flights.block[begun], slot[flights.disc[begun]]
        places[at], velocities[at] = place[begun], flights.velocity[begun]
        ended = np.flatnonzero((flights.kind == NO_EVENT) & (flights.block == len(edges) - 2))
        last = slot[flights.disc[ended]]
        places[-1, last], velocities[-1, last] = (place + flights.displacement)[ended], flights.end_velocity[ended]
    return places[back], velocities[back]
