"""Walls that let discs of some species pass, from both sides or from one.

A disc that can pass from both sides never touches the wall. For a disc that can pass from one side only, the wall is a
line with one closed face and solid ends. While the centre of the disc is on the open side, the disc does not touch the
face. Once the centre is beyond the line, the disc bounces when it touches the closed face or, while it still overlaps
the line, when its centre returns to the line.

Positions and velocities are measured away from the closed face: d is the distance of the disc's centre from the line
(length), negative on the open side; vn is the velocity (length/time) and an the acceleration (length/time²) along d.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.jit import inline
from idealgas.physics.motion import NEVER, time_to_plane

SOLID, FROM_LEFT, FROM_RIGHT, OPEN = range(4)
"""Sides from which a segment lets discs pass, seen from its start towards its end: none, one of them, or both."""

TOUCHING = 0.999
"""Distance from the line, in radii, above which a disc touches the closed face; below it, the disc overlaps the line.

Rounding errors are so small that a disc that touches a face is always above this distance.
"""


class Permeable(NamedTuple):
    """Sides from which each wall segment lets the discs of each species pass.

    Attributes:
        species: (N,) u2 by id, species of each disc.
        passage: (segments, species) u1, one of SOLID, FROM_LEFT, FROM_RIGHT and OPEN.
    """

    species: np.ndarray
    passage: np.ndarray


@inline
def passage_of(permeable, disc_id, segment):
    """Sides from which a segment lets a disc pass; None if no wall is permeable.

    segment: number of the segment.
    """
    if permeable is not None:
        return permeable.passage[np.uintp(segment), np.uintp(permeable.species[np.uintp(disc_id)])]
    return None


@inline
def closed_side(passage):
    """Side of a segment's closed face: 1 if it is on the left of the segment, -1 if it is on the right.

    passage: FROM_LEFT or FROM_RIGHT.
    """
    return -1.0 if passage == FROM_LEFT else 1.0


@inline
def closed_face_delay(d, vn, an, r):
    """Time until a disc touches the line of the closed face, or its centre returns to this line; NEVER if neither.

    d, vn, an: position, velocity and acceleration of the disc away from the closed face. r: radius of the disc, length.
    """
    if d <= 0.0 and (vn < 0.0 or vn * vn <= 2.0 * an * d):
        return NEVER  # the disc stays on the open side
    falls_back = (vn > 0.0) & (an < 0.0) & (vn * vn >= 2.0 * an * (d - r))  # after it no longer overlaps the line
    return time_to_plane(d - r if (d > TOUCHING * r) | falls_back else d, vn, an)


@inline
def touches_face(d, end_distance, r):
    """Whether a disc of radius r in contact with a segment touches the closed face and not an end.

    The foot of the perpendicular from the disc's centre must be on the segment. end_distance: distance between the
    disc's centre and the nearer end, length.
    """
    return min(abs(d - r), abs(d)) < abs(end_distance - r)


@inline
def nearest_end(x, y, s, length, tx, ty):
    """Position (x, y) of a disc relative to the nearer end of a segment, and its distance from that end, length.

    x, y: position relative to the start of the segment, length. s: component of this position along the segment,
    length. length, tx, ty: length and unit tangent of the segment.
    """
    if 2.0 * s > length:
        x -= length * tx
        y -= length * ty
    return x, y, math.sqrt(x * x + y * y)
