"""Escapes through a hole: their number, times and paths, of discs whose motion is known, and what theory predicts."""

import math

import numpy as np
import pytest
from helpers.logs import log_of

from idealgas import escape
from idealgas.analysis.escape import BILLIARD
from idealgas.tallies.reach import reach_of
from idealgas.theory import hard_discs

pytestmark = [pytest.mark.interpreted, pytest.mark.usefixtures("uncompiled")]

HOLE = """
box.size = [10, 8]
wall = [{ from = [9, 2], to = [9, 6], absorbing = true }]
run.until = 12
"""
DISC = "[[disc]]\nposition = [{}, {}]\nvelocity = [{}, 0]\nradius = {}\n"


def measured(text, **window):
    return escape(log_of(text), **window)


def test_two_discs_that_leave_and_one_that_does_not():
    """At 1 and 2 to the hole at x = 9 - R from x = 2: at t = 6.9 and 3.45; the third flies below the hole, 12 long."""
    result = measured(HOLE + DISC.format(2, 3, 1, 0.1) + DISC.format(2, 5, 2, 0.1) + DISC.format(5, 1, 1, 0.1))
    assert (result.discs, result.escaped) == (3, 2)
    assert result.per_path.value == pytest.approx(2 / (6.9 + 6.9 + 12), rel=1e-12)
    assert result.per_path.standard_error == pytest.approx(result.per_path.value / math.sqrt(2), rel=1e-12)
    assert result.mean_time.value == pytest.approx((6.9 + 3.45 + 12) / 2, rel=1e-12)
    assert result.mean_time.standard_error == pytest.approx(result.mean_time.value / math.sqrt(2), rel=1e-12)
    assert result.left.tolist() == [3 - (t >= 3.45) - (t >= 6.9) for t in result.time.tolist()]
    assert result.mean_time.theory is None  # for discs of one speed only
    assert result.caveats == (BILLIARD,)
    area = 9.8 * 7.8 - 4 * 0.2 - math.pi * 0.01  # of the centres
    length = 8 + 2 * math.pi * 0.1  # both faces of the hole and its round ends
    assert result.per_path.theory == pytest.approx(length / (math.pi * area), rel=1e-6)
    around = 2 * (9.8 + 7.8) + length
    density = (6.9 + 3.45 + 12) / 12 / 80  # mean in time
    free = hard_discs.mean_free_path(0.2, density, density * math.pi * 0.01)
    error = length / around + 2 * 3 * math.pi * 0.01 / 80 + 0.245 * length / free
    assert result.per_path.theory_error == pytest.approx(error * result.per_path.theory, rel=1e-6)
    assert result.expected[0] == 3
    rates = result.per_path.theory * np.array([1.0, 2.0, 1.0])
    assert result.expected == pytest.approx(np.exp(-np.multiply.outer(result.time, rates)).sum(axis=1), rel=1e-12)


def test_a_hole_of_many_mean_free_paths_has_no_theory():
    discs = "".join(DISC.format(x, y, 1, 0.1) for x in np.arange(0.5, 8.6, 0.5) for y in np.arange(0.5, 7.6, 0.5))
    result = measured(HOLE.replace("until = 12", "until = 0.5") + discs)
    assert result.per_path.theory is None
    (sentence,) = result.caveats
    assert sentence.startswith("Theory is not available: the holes are ")
    assert sentence.endswith(" mean free paths long, not small.")


def test_a_window_counts_what_happens_in_it():
    result = measured(HOLE + DISC.format(2, 3, 1, 0.1) + DISC.format(2, 5, 2, 0.1), start=4.0)
    assert (result.discs, result.escaped, result.left[0], result.left[-1]) == (1, 1, 1, 0)
    assert result.mean_time.value == pytest.approx(2.9, rel=1e-12)
    theory = 1 / result.per_path.theory
    assert result.mean_time.theory == pytest.approx(theory, rel=1e-12)  # at the speed 1


def test_discs_that_meet_are_no_billiard():
    """Two that exchange their velocities at x = 4 ± R, t = 1.8: 2 collisions of discs for one escape, at 6.9."""
    text = HOLE + DISC.format(2, 4, 1, 0.1) + DISC.format(6, 4, -1, 0.1)
    result = measured(text.replace("until = 12", "until = 7.5"))
    assert result.escaped == 1
    assert result.caveats == (
        "Theory for the number of remaining discs is not available: discs neither keep their speeds nor reach "
        "equilibrium before they leave.",
    )


R = 0.3
HIDDEN = math.asin(0.1 / R)  # of an end 0.1 nearer to a side than a disc that touches both beside the wall
TRAP = "{ from = [4, 4], to = [6, 4], absorbing = true }"


@pytest.mark.parametrize(
    ("walls", "length", "shared"),
    [
        (TRAP, 4 + 2 * math.pi * R, 0),
        ("{ from = [5, 0], to = [5, 3], absorbing = true }", 2 * (3 - R) + math.pi * R, 0),
        ("{ from = [5, 0.2], to = [5, 3], absorbing = true }", 2 * (3 - R) + math.pi * R, 0),
        ("{ from = [5, 0.4], to = [5, 3], absorbing = true }", 2 * 2.6 + (math.pi + 2 * HIDDEN) * R, 0),
        ("{ from = [5, 0], to = [5, 8], absorbing = true }", 2 * (8 - 2 * R), 0),
        ("{ from = [4, 4], to = [6, 4], via = [5, 5], absorbing = true }", 2 * math.pi + 2 * math.pi * R, 0),
        ("{ from = [4, 4], to = [4, 4], via = [6, 4], absorbing = true }", 4 * math.pi, 0),
        (TRAP + ", { from = [6, 4], to = [6, 6], absorbing = true }", 8 - 2 * R + 2.5 * math.pi * R, 0),
        (TRAP + ", { from = [6, 4], to = [6, 6] }", 4 - R + 1.25 * math.pi * R, math.pi * R / 4),
        (TRAP + ", { from = [6, 4], to = [8, 4] }", 4 + math.pi * R, 0),
        (TRAP + ", { from = [6, 2], to = [6, 6] }", 2 * (2 - R) + math.pi * R, 0),
        (TRAP + ", { from = [6.4, 2], to = [6.4, 6] }", 4 + (math.pi + 2 * HIDDEN) * R, 0),
    ],
    ids=[
        "free", "on a side", "close to a side", "near a side", "across", "half a circle", "circle", "corner",
        "corner with another wall", "in line", "on a wall", "near a wall",
    ],
)  # fmt: skip
def test_the_length_of_a_hole_is_that_of_all_centres_that_touch_it(walls, length, shared):
    """Faces on both sides and an arc of the radius around each end, without what other walls hide."""
    text = f"box.size = [10, 8]\nwall = [{walls}]\nrun.until = 0.01\n" + DISC.format(2, 2, 1, R)
    reach = reach_of(log_of(text), R)
    assert (reach.holes, reach.shared) == pytest.approx((length, shared), rel=1e-7)
