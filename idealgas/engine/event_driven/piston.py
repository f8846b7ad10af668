"""Pistons in the schedule. Each piston has a leaf in the tree, which holds its earliest contact with any disc."""

import numpy as np

from idealgas.engine.event_driven.prediction import FIRST_WALL, NO_CONTACT, SIDE_OF_BOX, precedes
from idealgas.engine.event_driven.scheduler import update
from idealgas.jit import inline
from idealgas.physics.absorbing import has_left
from idealgas.physics.piston import misses_piston_until, piston_contact, stop_contact

U = np.uintp


@inline
def keep_if_earlier(record, ids, prediction, j, piston, effects):
    """Store disc j's contact with a piston and return True if it is the piston's earliest contact so far."""
    if has_left(record[U(j)], effects.absorbing):
        return False
    if misses_piston_until(record[U(j)], piston, effects.gravity, prediction.contact):
        return False
    time = piston_contact(record[U(j)], piston, effects.gravity)
    earlier = time < prediction.contact
    if time == prediction.contact:
        rank = np.int64(FIRST_WALL + piston.wall)
        earlier = precedes(np.int64(ids[U(j)]), rank, np.int64(ids[U(prediction.partner)]), rank)
    if earlier:
        prediction.contact = time
        prediction.partner = j
        prediction.partner_count = record[U(j)].count
    return earlier


@inline
def predict_piston(record, ids, state, leaf, piston, effects):
    """Predict the next event of a piston, a contact with a disc or a side of the box, and schedule it.

    leaf: leaf of the piston in the tree.
    """
    if piston is not None:
        p = piston[U(leaf - ids.shape[0])]
        prediction = state.prediction[U(leaf)]
        prediction.contact = NO_CONTACT
        prediction.partner = -1
        for j in range(ids.shape[0]):
            keep_if_earlier(record, ids, prediction, j, p, effects)
        prediction.crossing = stop_contact(p)
        prediction.crossing_code = SIDE_OF_BOX + p.wall
        update(state.tree, state.prediction, ids, leaf)


@inline
def predict_pistons(record, ids, state, piston, effects):
    """Predict the next events of all pistons."""
    if piston is not None:
        for k in range(piston.shape[0]):
            predict_piston(record, ids, state, ids.shape[0] + k, piston, effects)


@inline
def offer_to_pistons(record, ids, state, i, piston, effects):
    """Update the next contact of each piston after the velocity or position of disc i has changed."""
    if piston is not None:
        for k in range(piston.shape[0]):
            leaf = ids.shape[0] + k
            if keep_if_earlier(record, ids, state.prediction[U(leaf)], i, piston[U(k)], effects):
                update(state.tree, state.prediction, ids, leaf)
