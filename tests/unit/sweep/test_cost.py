"""Time of a sweep from the costs of its points."""

import pytest

from idealgas.sweep.cost import START, Cost, total_seconds


@pytest.mark.parametrize(("seconds", "workers", "total"), [([6, 6, 6, 6], 2, 12), ([1, 1, 40], 3, 40), ([5], 8, 5)])
def test_workers_share_the_points_but_no_point_is_shared(seconds, workers, total):
    costs = [Cost(100, 0.1, 1e6, 1e6, each) for each in seconds]
    assert total_seconds(costs, workers) == START + total
