"""The tournament tree against sorting, with ties."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from idealgas._jit import aligned, njit
from idealgas.engine.event_driven.scheduler import PREDICTION, SIDE_OF_BOX, clear, make_tree, next_disc, schedule
from idealgas.engine.order import precedes, wall_rank

pytestmark = pytest.mark.interpreted


@njit
def enter(tree, predictions, ids, i):
    schedule(tree, predictions, ids, i)
    return next_disc(tree)


def first_by_sorting(entries, ids):
    """The disc whose (time, partner or None, side or None) comes first: crossings, then the written rule."""
    best = None
    for i, (time, partner, side) in enumerate(entries):
        if time is None:
            continue
        own = int(ids[i])
        if side is not None and side < SIDE_OF_BOX:
            event = (-1, own)
        else:
            event = (own, wall_rank(side - SIDE_OF_BOX) if partner is None else int(ids[partner]))
        if best is None or time < best[0] or (time == best[0] and precedes(*event, *best[1])):
            best = (time, event, i)
    return best[2]


times = st.integers(0, 4).map(float)


@settings(max_examples=60)
@given(st.integers(1, 100).flatmap(lambda n: st.tuples(st.just(n), st.integers(0, 2**32), st.integers(1, 60))))
def test_the_root_is_the_next_event(case):
    n, seed, updates = case
    draw = np.random.default_rng(seed)
    ids = draw.permutation(n).astype(np.uint32)
    tree, predictions = make_tree(n), aligned(n, PREDICTION)
    clear(tree.key)
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

    for i in range(n):
        root = renew(i)
    assert root == first_by_sorting(entries, ids)
    for _ in range(updates):
        root = renew(int(draw.integers(n)))
        found, expected = entries[root], entries[first_by_sorting(entries, ids)]
        assert found[0] == expected[0]
        pair = {root, found[1]} if found[1] is not None else {root, found[2]}
        i = first_by_sorting(entries, ids)
        assert pair == ({i, expected[1]} if expected[1] is not None else {i, expected[2]})
