"""The written rule for simultaneous events: smaller id, then walls in their order, then the other id."""

import random

import pytest

from idealgas.engine.event_driven.prediction import precedes, wall_rank

pytestmark = pytest.mark.interpreted


def test_the_order_of_simultaneous_events():
    events = [
        (0, wall_rank(0)),
        (0, wall_rank(2)),
        (0, 1),
        (0, 7),
        (1, wall_rank(3)),
        (1, 2),
        (5, wall_rank(1)),
        (5, 6),
    ]
    for k, first in enumerate(events):
        for second in events[k + 1 :]:
            for a in (first, first[::-1] if first[1] >= 0 else first):
                for b in (second, second[::-1] if second[1] >= 0 else second):
                    assert precedes(*a, *b)
                    assert not precedes(*b, *a)


def test_no_event_precedes_itself():
    for event in ((0, 1), (1, 0), (3, wall_rank(2))):
        assert not precedes(*event, *event)
    assert not precedes(4, 2, 2, 4)


def test_it_is_an_order():
    draw = random.Random(1)
    events = [(draw.randrange(6), draw.choice([wall_rank(draw.randrange(4)), draw.randrange(6)])) for _ in range(12)]
    for a in events:
        for b in events:
            for c in events:
                if precedes(*a, *b) and precedes(*b, *c):
                    assert precedes(*a, *c)
