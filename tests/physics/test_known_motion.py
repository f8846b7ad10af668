"""Shipped scenes whose motion is known by hand, as their comments tell it."""

import math

import numpy as np
import pytest
from helpers.logs import log_of

CORNER = [
    (1.0, 0, -1), (1.0, 0, -3), (1.25, 3, 4), (1.25, 4, 3), (1.5, 1, 2), (1.5, 2, 1),
    (2.25, 4, -2), (4.5, 1, -4), (8.0, 0, -2), (8.0, 0, -4),
]  # fmt: skip
"""Time, disc and partner of every row; walls are -1 left, -2 right, -3 bottom, -4 top."""


def motion(log):
    """Rows (time, disc, partner) of a run, and the state at its end."""
    rows = [row for batch in log.events() for row in zip(*(c.tolist() for c in batch[:3]), strict=True)]
    return rows, log.state_at(log.end_time)


@pytest.mark.parametrize("method", ["event_driven", "brute_force"])
def test_corner(method):
    """Sums of powers of two throughout: exact to the last bit."""
    rows, end = motion(log_of("corner", f"run.method={method}"))
    assert rows == CORNER
    assert end.time == 10
    assert end.position.tolist() == [[5.5, 5.5], [1, 5], [1, 1.5], [1.875, 1], [3.625, 1]]
    assert end.velocity.tolist() == [[-1, -1], [0, -0.5], [0, -0.5], [-0.5, 0], [-0.5, 0]]


@pytest.mark.parametrize("method", ["event_driven", "brute_force"])
def test_three_discs_return_after_a_period(method):
    """A period multiplies a deviation by 2500, the one of rounding at the start (4 ulp of the box, 7e-15) too."""
    period = 12.4 - 2 * math.sqrt(2)
    rows, end = motion(log_of("three-discs", f"run.method={method}", f"run.until={period!r}"))
    meetings = [(time, disc, partner) for time, disc, partner in rows if partner > disc]
    assert [row[1:] for row in meetings] == [(1, 2), (1, 2), (0, 1), (0, 1)]
    turn = 5.2 - math.sqrt(2)
    assert [row[0] for row in meetings] == pytest.approx([0.5, 0.5 + turn, 1.5 + turn, 1.5 + 2 * turn], abs=1e-12)
    assert len(rows) == 2 * 4 + 6
    tolerance = 2500 * 4 * np.spacing(10.2)
    assert np.abs(end.position - [[3.1, 3.6], [5.1, 2.6], [7.1, 3.6]]).max() < tolerance
    assert np.abs(end.velocity - [[-1, 0], [1, 0], [-1, 0]]).max() < tolerance
