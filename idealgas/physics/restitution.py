"""Inelastic collisions, and a rule that prevents inelastic collapse (infinitely many collisions in a finite time).

A collision is elastic if at least one of the colliding discs had its last collision, with a disc or a wall, less than
the contact duration ago (the TC model of Luding & McNamara, Granular Matter 1, 113 (1998)).
"""

from typing import NamedTuple

import numpy as np

from idealgas.jit import inline


class Restitution(NamedTuple):
    """Coefficients of inelastic collisions, and the time of each disc's last collision.

    Attributes:
        normal: coefficient of normal restitution for collisions of two discs.
        wall: coefficient of normal restitution for collisions of a disc with a wall.
        contact_duration: duration after a collision during which a disc collides elastically, time.
        last: (N,) f8 by id, local time of each disc's last collision.
    """

    normal: float
    wall: float
    contact_duration: float
    last: np.ndarray


def end_epoch(restitution: Restitution, length: float) -> None:
    """Shift the local times of the last collisions so that they count from the end of the epoch.

    length: duration of the epoch, time.
    """
    restitution.last[:] -= length


@inline
def restitution_factor(restitution, a_id, b_id, time):
    """Return 1 + the coefficient of restitution for a collision of two discs, or 2 if the collision is elastic.

    time: local time of the collision.
    """
    if restitution is not None:
        last = max(restitution.last[np.uintp(a_id)], restitution.last[np.uintp(b_id)])
        return 2.0 if time - last < restitution.contact_duration else 1.0 + restitution.normal
    return 2.0


@inline
def wall_restitution_factor(restitution, disc_id, time):
    """Return 1 + the coefficient of restitution for a hit of a disc on a wall, or 2 if the hit is elastic.

    time: local time of the hit.
    """
    if restitution is not None:
        recent = time - restitution.last[np.uintp(disc_id)] < restitution.contact_duration
        return 2.0 if recent else 1.0 + restitution.wall
    return 2.0


@inline
def record_collision(restitution, disc_id, time):
    """Store the local time of a disc's last collision if collisions are inelastic."""
    if restitution is not None:
        restitution.last[np.uintp(disc_id)] = time
