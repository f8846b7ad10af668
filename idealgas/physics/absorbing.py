"""Walls that absorb discs: a disc that touches such a wall leaves the gas.

Once a disc has left, its coordinates are nan and its velocity is 0; the disc belongs to no cell and takes part in no
event.
"""

import math

import numpy as np

from idealgas.jit import inline

U = np.uintp


@inline
def has_left(disc, absorbing):
    """Whether a disc has left the gas.

    absorbing: (segments,) bool, whether each wall segment absorbs discs; None if no segment does.
    """
    if absorbing is not None:
        return disc.x != disc.x
    return False


def inside(x: np.ndarray, absorbing: np.ndarray | None) -> np.ndarray | slice:
    """Mask (N,) of the discs that are still in the gas; a slice of all discs if no wall absorbs discs.

    x: (N,) x coordinates of the discs, length; nan for discs that have left.
    """
    return slice(None) if absorbing is None else ~np.isnan(x)


@inline
def mass_in_gas(disc, absorbing):
    """Mass of a disc; 0 if it has left the gas."""
    return 0.0 if has_left(disc, absorbing) else disc.m


@inline
def leave_gas(disc, disc_id, rotation):
    """Mark a disc as having left the gas."""
    disc.x = disc.y = math.nan
    disc.vx = disc.vy = 0.0
    if rotation is not None:
        rotation.omega[U(disc_id)] = 0.0
