"""Predictions for each disc: its next contact, and its next cell crossing, side or thermostat collision."""

import numpy as np

from idealgas.columns import FIRST_SEGMENT, HEAT_BATH
from idealgas.engine.order import precedes, wall_rank
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
        (
            "crossing_code",
            "i4",
        ),  # 0-3: crosses to the cell left, right, below, above; 4-7: meets that side; or THERMOSTAT
    ],
    align=True,
)
SIDE_OF_BOX = 4
THERMOSTAT = SIDE_OF_BOX + HEAT_BATH
"""Codes of what is no cell crossing: SIDE_OF_BOX and the number of what the disc meets."""

NO_CONTACT = 0.5 * NEVER  # before NEVER: a pair without a contact, at NEVER, is not simultaneous with it

U = np.uintp  # unsigned: negative indices need not be checked for


@inline
def segment_partner(segment):
    """Number that stands for a wall segment among the partners of a prediction."""
    return -2 - segment


@inline
def segment_of(partner):
    """Number of the wall segment that a prediction's partner stands for."""
    return -2 - partner


@inline
def images_of(prediction):
    """Numbers of box lengths (x, y) between a disc's record and its partner."""
    return np.int64(prediction.image_x), np.int64(prediction.image_y)


@inline
def partner_rank(ids, partner):
    """Rank of a disc's partner in the order of simultaneous events: its id, or the rank of a wall."""
    if partner >= 0:
        return np.int64(ids[U(partner)])
    return np.int64(wall_rank(FIRST_SEGMENT + segment_of(partner)))


@inline
def contact_is_next(prediction, ids, i):
    """Whether a disc's next event is its contact, not its crossing.

    A crossing into a cell precedes all events of its time.
    """
    if prediction.contact != prediction.crossing:
        return prediction.contact < prediction.crossing
    if prediction.crossing_code < SIDE_OF_BOX or prediction.partner == -1 or i == ids.shape[0]:
        return False
    own = np.int64(ids[U(i)])
    return precedes(own, partner_rank(ids, prediction.partner), own, wall_rank(prediction.crossing_code - SIDE_OF_BOX))


@inline
def event_ids(prediction, ids, i):
    """The two ids by which a disc's next event is ordered among simultaneous ones.

    The last leaf, beyond the discs, is the piston's: its contact is a hit of its side, its crossing the end stop.
    """
    contact = contact_is_next(prediction, ids, i)
    side = np.int64(wall_rank(prediction.crossing_code - SIDE_OF_BOX))
    if i == ids.shape[0]:
        return (np.int64(ids[U(prediction.partner)]), side) if contact else (np.int64(-1), np.int64(-1))
    own = np.int64(ids[U(i)])
    if contact:
        return own, partner_rank(ids, prediction.partner)
    if prediction.crossing_code < SIDE_OF_BOX:
        return np.int64(-1), own
    return own, side
