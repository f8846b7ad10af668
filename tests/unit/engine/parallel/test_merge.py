"""Rows of several slabs are merged by time and delivered in batches."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from idealgas.columns import Kind, empty_batch
from idealgas.engine.parallel.merge import PendingRows, TiedRowsError, time_order

pytestmark = pytest.mark.interpreted


def rows_of(times, discs):
    batch = empty_batch(len(times))
    batch.time[:], batch.disc[:], batch.partner[:], batch.kind[:] = times, discs, -1, Kind.WALL
    return batch


def order_of_slabs(times, room=4):
    memory = np.full(room * len(times), -1.0)
    for k, part in enumerate(times):
        memory[k * room : k * room + len(part)] = part
    return time_order(memory, [len(part) for part in times]).tolist()


def test_rows_are_merged_by_time():
    assert order_of_slabs([[1.0, 3.0, 3.0, 2.5], [0.5, 4.0]]) == [4, 0, 3, 1, 2, 5]
    assert order_of_slabs([[], [2.0, 5.0], [3.0]]) == [4, 8, 5]
    assert order_of_slabs([[], []]) == []


@given(st.permutations(range(30)), st.lists(st.integers(0, 30), min_size=1, max_size=5))
def test_rows_of_any_order_are_merged_by_time(times, cuts):
    parts = np.split(np.array(times, float), sorted(cuts))
    first = np.concatenate([np.arange(len(part)) + 30 * k for k, part in enumerate(parts)])
    assert order_of_slabs(parts, room=30) == first[np.argsort(times)].tolist()


def test_rows_of_one_time_that_nobody_has_put_in_order_are_not_merged():
    """Also where one slab begins as the other ends."""
    slabs = ([1.0, 2.0], [2.0]), ([2.0], [2.0, 3.0]), ([2.0, 3.0, 2.0], [1.0]), ([1.0, 2.0], [2.0, 3.0])
    for times in slabs:
        for room in (3, 4, 2) if max(map(len, times)) == 2 else (3, 4):
            with pytest.raises(TiedRowsError):
                order_of_slabs(times, room)


def test_rows_are_handed_on_as_batches_have_room_and_pairs_stay_together():
    rows = rows_of([3.0, 3.0, 1.0, 2.0, 2.0], [1, 3, 7, 1, 2])
    rows.partner[:], rows.kind[:] = [3, 1, -1, 2, 1], [Kind.DISC, Kind.DISC, Kind.WALL, Kind.DISC, Kind.DISC]
    pending, sizes, discs = PendingRows(rows, np.array([2, 3, 4, 0, 1]), 100.0), [], []
    while len(pending):
        batch = empty_batch(3)
        sizes.append(pending.fill(batch))
        discs += batch.disc[: sizes[-1]].tolist()
    assert sizes == [3, 2]
    assert discs == [7, 1, 2, 1, 3]
    assert batch.time[0] == 103.0
