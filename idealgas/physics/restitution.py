"""Inelastic collisions, and the rule that prevents inelastic collapse, infinitely many collisions in a finite time.

A collision is elastic if one of its discs collided with a disc or a wall less than the contact duration before (the TC
model of Luding & McNamara, Granular Matter 1, 113 (1998)).
"""

from typing import NamedTuple

import numpy as np

from idealgas.jit import inline


class Restitution(NamedTuple):
    """Coefficients of inelastic collisions, and the time of each disc's last collision.

    Attributes:
        normal: coefficient of normal restitution of two discs.
        wall: coefficient of normal restitution of a disc and a wall.
        contact_duration: duration after a collision during which a disc collides elastically, time.
        last: (N,) f8 by id, local time of each disc's last collision.
    """

    normal: float
    wall: float
    contact_duration: float
    last: np.ndarray


def end_epoch(restitution: Restitution, length: float) -> None:
    """Let the local times of the last collisions count from the end of the epoch; length: duration of the epoch."""
    restitution.last[:] -= length


@inline
def restitution_factor(restitution, a_id, b_id, time):
    """Return 1 + the coefficient of restitution, or 2 if elastic, for a collision of two discs at a local time."""
    if restitution is not None:
        last = max(restitution.last[np.uintp(a_id)], restitution.last[np.uintp(b_id)])
        return 2.0 if time - last < restitution.contact_duration else 1.0 + restitution.normal
    return 2.0


@inline
def wall_restitution_factor(restitution, disc_id, time):
    """Return 1 + the coefficient of restitution, or 2 if elastic, for a disc that hits a wall at a local time."""
    if restitution is not None:
        recent = time - restitution.last[np.uintp(disc_id)] < restitution.contact_duration
        return 2.0 if recent else 1.0 + restitution.wall
    return 2.0


@inline
def record_collision(restitution, disc_id, time):
    """Store the local time of a disc's last collision, if collisions are inelastic."""
    if restitution is not None:
        restitution.last[np.uintp(disc_id)] = time
