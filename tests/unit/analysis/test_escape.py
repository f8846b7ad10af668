"""Escapes through a hole: their number, times and paths, of discs whose motion is known, and what theory predicts."""

import math

import numpy as np
import pytest

from idealgas import escape, open_log, parse_scene, simulate
from idealgas.analysis.escape import BILLIARD

pytestmark = [pytest.mark.interpreted, pytest.mark.usefixtures("uncompiled")]

HOLE = """
box.size = [10, 8]
wall = [{ from = [9, 2], to = [9, 6], absorbing = true }]
run.until = 12
"""
DISC = "[[disc]]\nposition = [{}, {}]\nvelocity = [{}, 0]\nradius = {}\n"


def measured(tmp_path, text, **window):
    simulate(parse_scene(text), tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        return escape(log, **window)


def test_two_discs_that_leave_and_one_that_does_not(tmp_path):
    """At 1 and 2 to the hole at x = 9 - R from x = 2: at t = 6.9 and 3.45; the third flies below the hole, 12 long."""
    found = measured(tmp_path, HOLE + DISC.format(2, 3, 1, 0.1) + DISC.format(2, 5, 2, 0.1) + DISC.format(5, 1, 1, 0.1))
    assert (found.discs, found.escaped) == (3, 2)
    assert found.per_path.value == pytest.approx(2 / (6.9 + 6.9 + 12), rel=1e-12)
    assert found.per_path.standard_error == pytest.approx(found.per_path.value / math.sqrt(2), rel=1e-12)
    assert found.mean_time.value == pytest.approx((6.9 + 3.45 + 12) / 2, rel=1e-12)
    assert found.mean_time.standard_error == pytest.approx(found.mean_time.value / math.sqrt(2), rel=1e-12)
    assert found.left.tolist() == [3 - (t >= 3.45) - (t >= 6.9) for t in found.time.tolist()]
    assert found.mean_time.theory is None  # for discs of one speed only
    assert found.caveats == (BILLIARD,)
    area = 9.8 * 7.8 - 4 * 0.2 - math.pi * 0.01  # of the centres; both faces of the hole are 8 long
    assert found.per_path.theory == pytest.approx(8 / (math.pi * area), rel=1e-6)
    assert found.expected[0] == 3
    rates = found.per_path.theory * np.array([1.0, 2.0, 1.0])
    assert found.expected == pytest.approx(np.exp(-np.multiply.outer(found.time, rates)).sum(axis=1), rel=1e-12)


def test_a_window_counts_what_happens_in_it(tmp_path):
    found = measured(tmp_path, HOLE + DISC.format(2, 3, 1, 0.1) + DISC.format(2, 5, 2, 0.1), start=4.0)
    assert (found.discs, found.escaped, found.left[0], found.left[-1]) == (1, 1, 1, 0)
    assert found.mean_time.value == pytest.approx(2.9, rel=1e-12)
    theory = 1 / found.per_path.theory
    assert found.mean_time.theory == pytest.approx(theory, rel=1e-12)  # at the speed 1


def test_discs_that_meet_are_no_billiard(tmp_path):
    """Two that exchange their velocities at x = 4 ± R, t = 1.8: 2 collisions of discs for one escape, at 6.9."""
    text = HOLE + DISC.format(2, 4, 1, 0.1) + DISC.format(6, 4, -1, 0.1)
    found = measured(tmp_path, text.replace("until = 12", "until = 7.5"))
    assert found.escaped == 1
    assert found.caveats == (
        "No theory of the number left: discs neither keep their speeds nor come to equilibrium before they leave.",
    )
