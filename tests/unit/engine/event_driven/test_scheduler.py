"""The tournament tree against sorting, with ties."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from idealgas.engine.event_driven.prediction import FIRST_WALL, PREDICTION, SIDE_OF_BOX, precedes
from idealgas.engine.event_driven.scheduler import (
    NO_TIE,
    clear,
    has_other_event,
    make_tree,
    next_event,
    push,
    remove,
    resolve_ties,
    update,
)
from idealgas.jit import aligned, njit

pytestmark = pytest.mark.interpreted


@njit
def enter(tree, predictions, ids, i):
    """The next disc after disc i's event was entered in place of another, found as the kernel and `receive` do it."""
    before, _ = next_event(tree)
    update(tree, predictions, ids, i)
    time, first = next_event(tree)
    if time < before:
        tree.tie_time[0] = NO_TIE
    remove(tree, predictions, ids, first)
    if next_event(tree)[0] != time or tree.tie_time[0] == time:
        push(tree, predictions, ids, first)
    else:
        resolve_ties(tree, predictions, ids, first, -1)
    return next_event(tree)[1]


def first_by_sorting(entries, ids):
    """The disc whose (time, partner or None, side or None) comes first: crossings, then the written rule."""
    best = None
    for i, (time, partner, side) in enumerate(entries):
        if time is None:
            continue
        disc_id = int(ids[i])
        if side is not None and side < SIDE_OF_BOX:
            event = (-1, disc_id)
        else:
            event = (disc_id, FIRST_WALL + side - SIDE_OF_BOX if partner is None else int(ids[partner]))
        if best is None or time < best[0] or (time == best[0] and precedes(*event, *best[1])):
            best = (time, event, i)
    return best[2]


times = st.integers(0, 4).map(float)


@settings(max_examples=60)
@given(st.integers(1, 300).flatmap(lambda n: st.tuples(st.just(n), st.integers(0, 2**32), st.integers(1, 60))))
def test_the_root_is_the_next_event(case):
    n, seed, updates = case
    draw = np.random.default_rng(seed)
    ids = draw.permutation(n).astype(np.uint32)
    tree, predictions = make_tree(n), aligned(n, PREDICTION)
    clear(tree)
    entries = [(None, None, None)] * n

    def renew(i):
        predictions[i].contact = predictions[i].crossing = 1e9
        predictions[i].partner = -1
        time = float(draw.integers(5))
        kind = draw.integers(3) if n > 1 else draw.integers(2)
        if kind == 2:
            partner = int((i + 1 + draw.integers(n - 1)) % n)
            predictions[i].contact, predictions[i].partner = time, partner
            entries[i] = (time, partner, None)
        else:
            side = int(draw.integers(4)) + SIDE_OF_BOX * int(kind)
            predictions[i].crossing, predictions[i].crossing_code = time, side
            entries[i] = (time, None, side)
        return enter(tree, predictions, ids, i)

    def is_first(root):
        """Whether the root has the event that comes first; both discs of a pair may have foretold it."""
        result, i = entries[root], first_by_sorting(entries, ids)
        expected = entries[i]
        pair = {root, result[2] if result[1] is None else result[1]}
        return result[0] == expected[0] and pair == {i, expected[2] if expected[1] is None else expected[1]}

    for i in range(n):
        root = renew(i)
    assert is_first(root)
    for _ in range(updates):
        assert is_first(renew(int(draw.integers(n))))


@njit
def ask(tree, predictions, i, j, time):
    return has_other_event(tree, predictions, i, j, time)


@pytest.mark.parametrize(
    ("partner", "contact", "crossing", "expected"),
    [
        (0, 2.0, 3.0, False),  # the same contact, foretold by both
        (2, 2.0, 3.0, True),  # one with a third disc
        (0, 2.0, 2.0, True),  # a crossing, which precedes the contact
        (2, 4.0, 3.0, False),  # later
    ],
)
def test_a_partner_may_have_another_event_at_that_time(partner, contact, crossing, expected):
    ids, tree, predictions = np.arange(3, dtype=np.uint32), make_tree(3), aligned(3, PREDICTION)
    clear(tree)
    predictions[1].partner, predictions[1].contact, predictions[1].crossing = partner, contact, crossing
    enter(tree, predictions, ids, 1)
    assert ask(tree, predictions, 0, 1, 2.0) == expected
