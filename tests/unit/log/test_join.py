"""States of discs before their events, by hand."""

import numpy as np
import pytest

from idealgas.log.join import Join
from idealgas.log.replay import LogState

pytestmark = pytest.mark.interpreted


def test_states_pass_from_each_event_of_a_disc_to_its_next():
    """Also through a part of the log without rows, and by ids that do not fit into 16 bits."""
    join = Join(LogState(0.0, np.zeros((70_000, 2)), np.zeros((70_000, 2))), ["velocity"])

    def before(times, discs):
        rows = {"time": np.array(times, float), "disc": np.array(discs, np.uint32)}
        rows["velocity"] = np.column_stack((rows["time"], rows["disc"]))
        result = join.pass_on(rows)
        assert result["velocity"][:, 0].tolist() == result["time"].tolist()
        return result["time"].tolist()

    assert before([1, 2, 3, 4, 4], [1, 65_537, 1, 0, 1]) == [0, 0, 1, 0, 3]
    assert before([], []) == []
    assert before([5, 6, 7], [65_537, 1, 2]) == [2, 4, 0]
    assert join.states(np.array([0, 1, 2, 65_537]))["time"].tolist() == [4, 6, 7, 5]
