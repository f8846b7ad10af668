"""Walls that let discs of some species pass, from both sides or from one.

A disc that passes a wall from both sides never meets it. For a disc that passes from one side, the wall is a line with
one closed face and solid ends, which it does not meet while its centre is on the open side. Beyond, the disc bounces
where it touches the closed face or, as long as it has not come out of the line, where its centre is back at it.

In coordinates of the closed face, d is the disc's distance from the line (length), negative on the open side, vn its
velocity (length/time) and an its acceleration (length/time²) away from the face.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.jit import inline
from idealgas.physics.motion import NEVER, time_to_plane

SOLID, FROM_LEFT, FROM_RIGHT, OPEN = range(4)
"""From where a segment lets discs pass, seen from its start towards its end: from no side, one, or both."""

TOUCHING = 0.999
"""Distance from the line, in radii, above which a disc touches the closed face; below, it has not come out of the line.

Rounding leaves a disc that touches a face far above.
"""


class Permeable(NamedTuple):
    """Which wall segments let which discs pass.

    Attributes:
        species: (N,) u2 by id, species of each disc.
        passage: (segments, species) u1, one of SOLID, FROM_LEFT, FROM_RIGHT and OPEN.
    """

    species: np.ndarray
    passage: np.ndarray


@inline
def passage_of(permeable, own, segment):
    """From where a segment, given by its number, lets a disc pass; None where no wall lets any disc pass."""
    if permeable is not None:
        return permeable.passage[np.uintp(segment), np.uintp(permeable.species[np.uintp(own)])]
    return None


@inline
def closed_side(passage):
    """1 if the closed face of a segment that lets discs pass from one side is on its left, -1 if on its right."""
    return -1.0 if passage == FROM_LEFT else 1.0


@inline
def closed_face_delay(d, vn, an, r):
    """Time until a disc of radius r touches the line of the closed face, or its centre is back at it; else NEVER."""
    if d <= 0.0 and (vn < 0.0 or vn * vn <= 2.0 * an * d):
        return NEVER  # it stays on the open side
    falls_back = (vn > 0.0) & (an < 0.0) & (vn * vn >= 2.0 * an * (d - r))  # once it has come out
    return time_to_plane(d - r if (d > TOUCHING * r) | falls_back else d, vn, an)


@inline
def touches_face(d, end_distance, r):
    """Whether a disc of radius r in contact, with its foot on the body, touches the closed face and not an end."""
    return min(abs(d - r), abs(d)) < abs(end_distance - r)


@inline
def nearest_end(x, y, s, length, tx, ty):
    """Position (x, y) relative to the nearer end of a segment, from that relative to its start, and the distance."""
    if 2.0 * s > length:
        x -= length * tx
        y -= length * ty
    return x, y, math.sqrt(x * x + y * y)
