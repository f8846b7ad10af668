"""Predictions for each disc, its next contact and its next crossing, and the order of simultaneous events.

Of simultaneous events, the smaller pair (smaller id, other id) comes first, where walls precede the heat bath and that
precedes any disc. Of simultaneous contacts with one partner in two images, that image comes first that is fewer box
lengths away from the disc with the smaller id, counted along x and then along y. The rule uses ids only, never indices
in memory, so every method and every renumbering gives the same order.
"""

import numpy as np

from idealgas.columns import FIRST_SEGMENT, HEAT_BATH
from idealgas.jit import inline
from idealgas.physics.motion import NEVER

PREDICTION = np.dtype(
    [
        ("contact", "f8"),  # local time of the earliest contact with a disc or a wall segment
        ("crossing", "f8"),  # local time at which the disc leaves its cell, meets a side of the box or the heat bath
        ("partner", "i4"),  # index of the other disc, -1 for none, -2 - k for wall segment k
        ("partner_count", "u4"),  # the partner's count when predicted: the contact is stale once it differs
        ("image_x", "i2"),  # box lengths to the partner's record or the segment, where sides are periodic
        ("image_y", "i2"),
        ("crossing_code", "i4"),  # 0-3: to the cell left, right, below, above; 4-7: meets that side; or THERMOSTAT
    ],
    align=True,
)
SIDE_OF_BOX = 4
THERMOSTAT = SIDE_OF_BOX + HEAT_BATH
"""Codes of other events than cell crossings: SIDE_OF_BOX plus the number of the side or the heat bath."""

NO_CONTACT = 0.5 * NEVER  # before NEVER: a pair without a contact, at NEVER, is not simultaneous with it

U = np.uintp  # unsigned: negative indices need not be checked for

FIRST_WALL = -(1 << 31)
"""Rank of wall 0 among a disc's partners, which are walls before discs; wall k has the rank FIRST_WALL + k."""

FIRST_WALL_SEGMENT = -2
"""What stands for wall segment 0 among the partners of a prediction; segment k is FIRST_WALL_SEGMENT - k."""


@inline
def precedes(a, b, c, d):
    """Whether the event of ids (a, b) comes before the simultaneous one of (c, d); b and d may be wall ranks."""
    a_low, a_high = (b, a) if 0 <= b < a else (a, b)
    c_low, c_high = (d, c) if 0 <= d < c else (c, d)
    return a_low < c_low or (a_low == c_low and a_high < c_high)


@inline
def image_precedes(own, other, images, others):
    """Whether a disc meets a partner in the image `images` before it meets it, at the same time, in the image `others`.

    images, others: numbers of box lengths (x, y). own: id of the disc. other: id or wall rank of the partner.
    """
    ahead = images[0] < others[0] or (images[0] == others[0] and images[1] < others[1])
    return ahead if other < 0 or own < other else images != others and not ahead


@inline
def images_of(prediction):
    """Numbers of box lengths (x, y) between a disc's record and its partner."""
    return np.int64(prediction.image_x), np.int64(prediction.image_y)


@inline
def partner_rank(ids, partner):
    """Rank of a disc's partner in the order of simultaneous events: its id, or the rank of a wall."""
    if partner >= 0:
        return np.int64(ids[U(partner)])
    return np.int64(FIRST_WALL + FIRST_SEGMENT + (FIRST_WALL_SEGMENT - partner))


@inline
def contact_is_next(prediction, ids, i):
    """Whether a disc's next event is its contact, not its crossing.

    A crossing into a cell precedes all events of its time.
    """
    if prediction.contact != prediction.crossing:
        return prediction.contact < prediction.crossing
    if prediction.crossing_code < SIDE_OF_BOX or prediction.partner == -1 or i >= ids.shape[0]:
        return False
    own = np.int64(ids[U(i)])
    side = np.int64(FIRST_WALL + (prediction.crossing_code - SIDE_OF_BOX))
    return precedes(own, partner_rank(ids, prediction.partner), own, side)


@inline
def event_ids(prediction, ids, i):
    """The two ids by which a disc's next event is ordered among simultaneous ones.

    Leaves beyond the discs are pistons': they meet a disc in their contact, a side of the box in their crossing.
    """
    contact = contact_is_next(prediction, ids, i)
    side = np.int64(FIRST_WALL + (prediction.crossing_code - SIDE_OF_BOX))
    if i >= ids.shape[0]:
        return (np.int64(ids[U(prediction.partner)]), side) if contact else (np.int64(-1), side)
    own = np.int64(ids[U(i)])
    if contact:
        return own, partner_rank(ids, prediction.partner)
    if prediction.crossing_code < SIDE_OF_BOX:
        return np.int64(-1), own
    return own, side
