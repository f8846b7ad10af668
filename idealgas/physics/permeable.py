"""Walls that let discs of some species pass, from both sides or from one.

A disc that passes a wall from both sides never meets it. For a disc that passes from one side, the wall is a line with
one closed face and solid ends. The disc does not meet the face while its centre is on the open side. Beyond the line,
it bounces when it touches the closed face or, as long as it still overlaps the line, when its centre comes back to the
line.

In coordinates of the closed face, d is the disc's distance from the line (length), negative on the open side, vn its
velocity (length/time) and an its acceleration (length/time²) away from the face.
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

Despite rounding, a disc that touches a face is far above this distance.
"""


class Permeable(NamedTuple):
    """Passage of the species of discs through wall segments.

    Attributes:
        species: (N,) u2 by id, species of each disc.
        passage: (segments, species) u1, one of SOLID, FROM_LEFT, FROM_RIGHT and OPEN.
    """

    species: np.ndarray
    passage: np.ndarray


@inline
def passage_of(permeable, disc_id, segment):
    """Sides from which a segment lets a disc pass; None if no wall is permeable. segment: number of the segment."""
    if permeable is not None:
        return permeable.passage[np.uintp(segment), np.uintp(permeable.species[np.uintp(disc_id)])]
    return None


@inline
def closed_side(passage):
    """Return 1 if the closed face of a segment that is open from one side is on its left, -1 if it is on its right."""
    return -1.0 if passage == FROM_LEFT else 1.0


@inline
def closed_face_delay(d, vn, an, r):
    """Time until a disc of radius r touches the closed face's line, or its centre is back at the line; or NEVER."""
    if d <= 0.0 and (vn < 0.0 or vn * vn <= 2.0 * an * d):
        return NEVER  # it stays on the open side
    falls_back = (vn > 0.0) & (an < 0.0) & (vn * vn >= 2.0 * an * (d - r))  # after it has left the line
    return time_to_plane(d - r if (d > TOUCHING * r) | falls_back else d, vn, an)


@inline
def touches_face(d, end_distance, r):
    """Whether a disc of radius r in contact, with its foot on the body, touches the closed face and not an end."""
    return min(abs(d - r), abs(d)) < abs(end_distance - r)


@inline
def nearest_end(x, y, s, length, tx, ty):
    """Position (x, y) relative to the nearer end of a segment, and its distance; x, y: relative to the start."""
    if 2.0 * s > length:
        x -= length * tx
        y -= length * ty
    return x, y, math.sqrt(x * x + y * y)
