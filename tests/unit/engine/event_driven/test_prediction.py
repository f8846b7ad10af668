"""The written rule for simultaneous events: smaller id, then walls in their order, then the other id."""

import random

import numpy as np
import pytest

from idealgas.columns import FIRST_SEGMENT, HEAT_BATH
from idealgas.engine.event_driven.prediction import (
    FIRST_WALL,
    FIRST_WALL_SEGMENT,
    PREDICTION,
    SIDE_OF_BOX,
    THERMOSTAT,
    contact_is_next,
    event_ids,
    image_precedes,
    partner_rank,
    precedes,
)
from idealgas.jit import aligned

pytestmark = [pytest.mark.interpreted, pytest.mark.filterwarnings("ignore:overflow encountered")]


def test_the_order_of_simultaneous_events():
    walls = [FIRST_WALL + k for k in range(4)]
    events = [(0, walls[0]), (0, walls[2]), (0, 1), (0, 7), (1, walls[3]), (1, 2), (5, walls[1]), (5, 6)]
    for k, first in enumerate(events):
        for second in events[k + 1 :]:
            for a in (first, first[::-1] if first[1] >= 0 else first):
                for b in (second, second[::-1] if second[1] >= 0 else second):
                    assert precedes(*a, *b)
                    assert not precedes(*b, *a)
    for event in ((0, 1), (1, 0), (3, FIRST_WALL + 2)):
        assert not precedes(*event, *event)
    assert not precedes(4, 2, 2, 4)
    draw = random.Random(1)
    events = [(draw.randrange(6), draw.choice([FIRST_WALL + draw.randrange(4), draw.randrange(6)])) for _ in range(12)]
    for a in events:
        for b in events:
            for c in events:
                if precedes(*a, *b) and precedes(*b, *c):
                    assert precedes(*a, *c)


def test_partners_that_are_walls():
    """Disc j stands for itself, -1 for none, and numbers below that for segments; their ranks follow the sides'."""
    for k in (0, 5, 1000):
        rank = partner_rank(np.array([7, 9]), FIRST_WALL_SEGMENT - k)
        assert FIRST_WALL_SEGMENT - k < -1
        assert rank == FIRST_WALL + FIRST_SEGMENT + k < FIRST_WALL + 2000
    assert partner_rank(np.array([7, 9]), 1) == 9


def prediction(contact, crossing, code, partner=1):
    record = aligned(1, PREDICTION)[0]
    record.contact, record.crossing, record.crossing_code, record.partner = contact, crossing, code, partner
    return record


@pytest.mark.parametrize(
    ("contact", "crossing", "code", "first", "ids"),
    [
        (1.0, 2.0, 0, True, (5, 9)),
        (2.0, 1.0, 0, False, (-1, 5)),  # into a cell
        (2.0, 1.0, SIDE_OF_BOX + 3, False, (5, FIRST_WALL + 3)),
        (1.0, 1.0, 0, False, (-1, 5)),  # a cell precedes all
        (1.0, 1.0, SIDE_OF_BOX + 3, False, (5, FIRST_WALL + 3)),  # and a wall a disc
        (1.0, 1.0, THERMOSTAT, False, (5, FIRST_WALL + HEAT_BATH)),
    ],
)
def test_which_of_two_events_of_a_disc_is_next(contact, crossing, code, first, ids):
    """Of disc 5 with disc 9, or a crossing."""
    event = prediction(contact, crossing, code)
    assert contact_is_next(event, np.array([5, 9]), 0) == first
    assert event_ids(event, np.array([5, 9]), 0) == ids


def test_images_of_one_partner_come_in_the_order_of_the_smaller_id():
    """Fewer box lengths along x, then y, first; seen from the disc with the larger id all signs are reversed."""
    for near, far in (((0, 5), (1, 0)), ((-1, 0), (0, 0)), ((0, -1), (0, 0))):
        for disc_id, rank in ((3, 8), (3, FIRST_WALL + 6)):
            assert image_precedes(disc_id, rank, near, far)
            assert not image_precedes(disc_id, rank, far, near)
        assert image_precedes(8, 3, far, near)
        assert not image_precedes(8, 3, near, far)
    assert not image_precedes(8, 3, (1, 1), (1, 1))
