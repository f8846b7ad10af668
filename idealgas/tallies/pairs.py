"""Distances between pairs of discs: bins of distance, and positions for k-d trees."""

import numpy as np

from idealgas.log import Log

BINS_A_DIAMETER = 20
REACH = 5.0
"""Largest distance in the bins, in diameters."""


def inside(log: Log, position: np.ndarray) -> np.ndarray:
    """Return positions (N, 2), length; those on an upper periodic side are moved inside, as `cKDTree` requires."""
    below = np.nextafter(log.box, 0.0)
    return np.where(log.periodic, np.clip(position, 0.0, below), position)
