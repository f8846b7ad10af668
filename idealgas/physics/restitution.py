"""Inelastic rebound, and the rule that keeps it from infinitely many collisions in a finite time.

A collision of a disc that met another disc or a wall less than the contact duration ago is elastic (the TC model of
Luding & McNamara, Granular Matter 1, 113 (1998)).
"""

from typing import NamedTuple

import numpy as np

from idealgas._jit import inline


class Restitution(NamedTuple):
    """normal, wall: coefficients for discs and for walls. contact_duration: time.

    last: (N,) f8 by id, local time of each disc's last collision.
    """

    normal: float
    wall: float
    contact_duration: float
    last: np.ndarray


def end_epoch(restitution: Restitution, length: float) -> None:
    """Count the local times of the last collisions from the end of an epoch."""
    restitution.last[:] -= length


@inline
def rebound(restitution, a_id, b_id, time):
    """1 + the coefficient of restitution of two discs that meet."""
    if restitution is not None:
        last = max(restitution.last[np.uintp(a_id)], restitution.last[np.uintp(b_id)])
        return 2.0 if time - last < restitution.contact_duration else 1.0 + restitution.normal
    return 2.0


@inline
def wall_rebound(restitution, own, time):
    """1 + the coefficient of restitution of a disc that meets a wall."""
    if restitution is not None:
        recent = time - restitution.last[np.uintp(own)] < restitution.contact_duration
        return 2.0 if recent else 1.0 + restitution.wall
    return 2.0


@inline
def record_collision(restitution, own, time):
    """Remember when a disc collided."""
    if restitution is not None:
        restitution.last[np.uintp(own)] = time
