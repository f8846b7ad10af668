"""Distances of pairs of discs: their bins, and positions for k-d trees."""

import numpy as np

from idealgas.log import Log

BINS_A_DIAMETER = 20
REACH = 5.0
"""Largest distance, in diameters."""


def inside(log: Log, position: np.ndarray) -> np.ndarray:
    """Return positions (N, 2), length, none of them on the upper one of two periodic sides, as `cKDTree` requires."""
    below = np.nextafter(log.box, 0.0)
    return np.where(log.periodic, np.clip(position, 0.0, below), position)
