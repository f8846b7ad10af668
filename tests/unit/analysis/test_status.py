"""Status of a log: its latest state, and the pressure from its latest events."""

import math

import numpy as np
import pytest
from helpers.logs import gas

from idealgas.analysis import status as module
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.pressure.routes import PAIRS
from idealgas.analysis.status import status

pytestmark = pytest.mark.interpreted


def test_state_of_two_discs(lanes):
    """Speeds in units of √(T/m), T = 1.875: √(m v²/T) with 2.5 and 5, against the law 1 - exp(-v²/2)."""
    result = status(lanes)
    assert (result.time, result.rows, result.events, result.temperature) == (180.0, len(lanes), len(lanes), 1.875)
    speeds = np.sqrt(np.array([2.5, 5.0]) / 1.875)
    assert result.density == pytest.approx(np.histogram(speeds, result.edges)[0] / 2 / 0.2, rel=1e-14)
    assert result.density.sum() * 0.2 == pytest.approx(1.0, rel=1e-14)
    below = 1 - np.exp(-(speeds**2) / 2)
    assert result.ks_distance == pytest.approx(max(below[0], 0.5 - below[0], below[1] - 0.5, 1 - below[1]), rel=1e-14)
    assert result.edges.tolist() == pytest.approx((np.arange(21) / 5).tolist())
    assert result.expected[5] == pytest.approx((math.exp(-0.5) - math.exp(-0.72)) / 0.2, rel=1e-12)
    assert result.pressure is result.compressibility_factor is None  # no two discs meet
    assert result.caveats == ()


def test_of_many_rows_the_first_after_a_checkpoint_are_read(lanes, monkeypatch):
    monkeypatch.setattr(module, "ROWS", 40)
    times = next(lanes.chunks(("time",))).time
    assert module._time_seen(lanes) == times[int(lanes.checkpoints.rows[-1]) + 39]
    monkeypatch.setattr(module, "ROWS", len(lanes))
    assert module._time_seen(lanes) == 180.0


@pytest.mark.usefixtures("uncompiled")
def test_the_pressure_is_that_of_the_virial_of_pairs(log):
    result = status(log)
    (route,) = (route for route in pressure(log, log.start_time, log.end_time).routes if route.name == PAIRS)
    assert (result.pressure, result.compressibility_factor) == (route.pressure, route.compressibility_factor)
    assert result.compressibility_factor.theory > 1


GAS = gas(12, 0.5, (6, 6), "until = 6")
