"""The predicted next contact and next crossing of each disc, and the order of simultaneous events.

Simultaneous events are ordered by the pair (smaller id, other id), where walls precede the heat bath and the heat bath
precedes all discs. If a disc touches two images of the same partner simultaneously, the images are ordered by their
shifts in box lengths, as seen from the disc with the smaller id: the smaller shift along x comes first and, if these
are equal, the smaller shift along y. The rule uses only ids, never indices in memory, so the order is the same for all
methods and does not depend on how the discs are sorted in memory.
"""

import numpy as np

from idealgas.columns import FIRST_SEGMENT, HEAT_BATH
from idealgas.jit import inline
from idealgas.physics.motion import NEVER

PREDICTION = np.dtype(
    [
        ("contact", "f8"),  # local time of the earliest contact with a disc or a wall segment
        ("crossing", "f8"),  # local time at which the disc leaves its cell, meets a side of the box or the heat bath
        ("partner", "i4"),  # index of the partner, -1 for none, -2 - k for wall segment k
        ("partner_count", "u4"),  # the partner's count when predicted; if it has changed, the contact is stale
        ("image_x", "i2"),  # box lengths by which the partner or the segment is shifted, if sides are periodic
        ("image_y", "i2"),
        ("crossing_code", "i4"),  # 0-3: enters the cell left, right, below, above; 4-7: meets that side; or THERMOSTAT
    ],
    align=True,
)
SIDE_OF_BOX = 4
THERMOSTAT = SIDE_OF_BOX + HEAT_BATH
"""Codes of events other than cell crossings: SIDE_OF_BOX plus the number of the side or the heat bath."""

NO_CONTACT = 0.5 * NEVER  # less than NEVER, so that a pair that never meets does not tie with it

U = np.uintp  # unsigned, so that the compiler need not check for negative indices

FIRST_WALL = -(1 << 31)
"""Rank of wall 0 among the partners of a disc. Wall k has rank FIRST_WALL + k, so walls come before discs."""

FIRST_WALL_SEGMENT = -2
"""Number that stands for wall segment 0 as the partner in a prediction; segment k is FIRST_WALL_SEGMENT - k."""


@inline
def precedes(a, b, c, d):
    """Whether the event of ids (a, b) precedes the simultaneous event of ids (c, d); b and d may be wall ranks."""
    a_low, a_high = (b, a) if 0 <= b < a else (a, b)
    c_low, c_high = (d, c) if 0 <= d < c else (c, d)
    return a_low < c_low or (a_low == c_low and a_high < c_high)


@inline
def image_precedes(disc_id, rank, images, other_images):
    """Whether a disc's contact with one image of a partner precedes its simultaneous contact with another image.

    rank: id or wall rank of the partner. images, other_images: shifts (x, y) of the two images in box lengths.
    """
    ahead = images[0] < other_images[0] or (images[0] == other_images[0] and images[1] < other_images[1])
    return ahead if rank < 0 or disc_id < rank else images != other_images and not ahead


@inline
def images_of(prediction):
    """Shift (x, y), in box lengths, from the recorded position of a disc's predicted partner to its image."""
    return np.int64(prediction.image_x), np.int64(prediction.image_y)


@inline
def partner_rank(ids, partner):
    """Rank of a disc's partner in the order of simultaneous events: the id of a disc, or the rank of a wall."""
    if partner >= 0:
        return np.int64(ids[U(partner)])
    return np.int64(FIRST_WALL + FIRST_SEGMENT + (FIRST_WALL_SEGMENT - partner))


@inline
def contact_is_next(prediction, ids, i):
    """Whether a disc's next event is its contact rather than its crossing.

    A crossing into another cell precedes all events at the same time.
    """
    if prediction.contact != prediction.crossing:
        return prediction.contact < prediction.crossing
    if prediction.crossing_code < SIDE_OF_BOX or prediction.partner == -1 or i >= ids.shape[0]:
        return False
    disc_id = np.int64(ids[U(i)])
    side = np.int64(FIRST_WALL + (prediction.crossing_code - SIDE_OF_BOX))
    return precedes(disc_id, partner_rank(ids, prediction.partner), disc_id, side)


@inline
def event_ids(prediction, ids, i):
    """Return the two ids by which a disc's next event is ordered among simultaneous events.

    Leaves after those of the discs belong to pistons. The contact of a piston is with a disc, and its crossing is a
    contact with a side of the box.
    """
    contact = contact_is_next(prediction, ids, i)
    side = np.int64(FIRST_WALL + (prediction.crossing_code - SIDE_OF_BOX))
    if i >= ids.shape[0]:
        return (np.int64(ids[U(prediction.partner)]), side) if contact else (np.int64(-1), side)
    disc_id = np.int64(ids[U(i)])
    if contact:
        return disc_id, partner_rank(ids, prediction.partner)
    if prediction.crossing_code < SIDE_OF_BOX:
        return np.int64(-1), disc_id
    return disc_id, side
