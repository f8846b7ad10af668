"""Escapes through a hole: their number, times and paths, of discs whose motion is known, and what theory predicts."""

import math

import numpy as np
import pytest
from helpers.logs import log_of

from idealgas import escape
from idealgas.analysis.escape import BILLIARD, _expected, _ratio
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.reach import reach_of
from idealgas.theory import hard_discs
from idealgas.theory.values import Theory

pytestmark = pytest.mark.usefixtures("uncompiled")

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


# ── species ──

SPECIES = DISC + "species = '{}'\nmass = {}\n"


def test_species_by_hand():
    """Light discs of radius 0.1 at the speed 2 and one heavy disc of radius 0.2 at 1, from x = 2 to the hole at 9 - R.

    Two of the light discs escape at t = 3.45, the heavy disc at 6.8; the last light disc flies below the hole.
    """
    light = [SPECIES.format(2, y, 2, 0.1, "light", 1) for y in (3, 5, 1)]
    result = measured(HOLE + SPECIES.format(2, 4, 1, 0.2, "heavy", 4) + "".join(light))
    assert list(result.species) == ["heavy", "light"]
    heavy, light = result.species.values()
    assert [(part.discs, part.escaped) for part in (result, heavy, light)] == [(4, 3), (1, 1), (3, 2)]
    assert heavy.per_path.value == pytest.approx(1 / 6.8, rel=1e-12)
    assert light.per_path.value == pytest.approx(2 / (6.9 + 6.9 + 24), rel=1e-12)
    assert light.mean_time.value == pytest.approx((3.45 + 3.45 + 12) / 2, rel=1e-12)
    assert (heavy.left + light.left).tolist() == result.left.tolist()
    assert light.left.tolist() == [3 - 2 * (t >= 3.45) for t in result.time.tolist()]
    # weights 1/4 and 1/3 of the heavy disc when light discs leave, and 1/2 of the light disc when the heavy disc leaves
    assert light.ratio.value == pytest.approx((1 / 4 + 1 / 3) / (1 / 2), rel=1e-12)
    variance = 1 / 16 + 1 / 9 + light.ratio.value**2 / 4
    assert light.ratio.standard_error == pytest.approx(2 * math.sqrt(variance), rel=1e-12)
    assert (heavy.ratio, result.per_path.theory) == (None, None)  # the two radii have different theories
    rates = []
    for part, radius, speed in ((heavy, 0.2, 1), (light, 0.1, 2)):
        area = (10 - 2 * radius) * (8 - 2 * radius) - 4 * 2 * radius - math.pi * radius**2
        rates.append((8 + 2 * math.pi * radius) / (math.pi * area))
        assert part.per_path.theory == pytest.approx(rates[-1], rel=1e-6)
        assert part.expected == pytest.approx(part.discs * np.exp(-rates[-1] * speed * result.time), rel=1e-6)
        assert part.mean_time.theory == pytest.approx(1 / (rates[-1] * speed), rel=1e-6)
    assert light.ratio.theory == pytest.approx(2 * rates[1] / rates[0], rel=1e-6)
    relative = [part.per_path.theory_error / part.per_path.theory for part in (heavy, light)]
    assert light.ratio.theory_error == pytest.approx(max(relative) * light.ratio.theory, rel=1e-12)
    assert result.expected == pytest.approx(heavy.expected + light.expected, rel=1e-12)
    assert "Ratio of the rates light / heavy: " in result.summary()
    plain = result.as_dict()["species"]["light"]
    assert plain["ratio"]["theory"] == light.ratio.theory
    assert plain["left"] == light.left.tolist()


def test_equal_discs_of_two_names_are_two_species():
    places = ((2, 3, "a"), (2, 4, "a"), (2.5, 5, "b"), (2, 1, "b"))
    text = [SPECIES.format(x, y, 1, 0.1, name, 1) for x, y, name in places]
    result = measured(HOLE + "".join(text))
    assert [part.ratio and part.ratio.theory for part in result.species.values()] == [None, 1.0]
    assert result.per_path.theory == result.species["a"].per_path.theory
    alone = measured("".join([HOLE, *text]).replace("'b'", "'a'"))
    assert alone.species is None
    assert alone.left.tolist() == result.left.tolist()
    assert alone.as_dict().keys() == result.as_dict().keys() - {"species"}


def test_the_ratio_compares_discs_that_are_still_there():
    """Twice the rate at each escape, exactly: of 2 and 4 discs, escapes in the order other, first, other, other."""
    is_other = np.array([True, False, True, True])
    ratio = _ratio(2, 4, is_other, Estimate(1.0, 0.0, math.inf, 2.0, 0.1))
    there, back = [2 / 6, 1 / 4, 1 / 3], [3 / 5]
    assert ratio.value == pytest.approx(sum(there) / sum(back), rel=1e-14)
    variance = sum(w**2 for w in there) + ratio.value**2 * back[0] ** 2
    assert ratio.standard_error == pytest.approx(math.sqrt(variance) / back[0], rel=1e-14)
    assert (ratio.theory, ratio.theory_error, ratio.independent_samples) == (2.0, 0.1, math.inf)
    assert _ratio(2, 4, np.array([True, True]), ratio) is None
    assert _ratio(2, 4, np.array([False]), ratio) is None


def test_a_mixture_cools_as_it_escapes():
    """T ∝ √N of all discs. Rates of both species have the ratio √(m₂/m₁) = 2 at any time: N₁/N₁₀ = (N₂/N₂₀)².

    With x = N₂/N₂₀ the rate of the heavy discs is dx/dt = -x r (N/N₀)^(1/4), whose integral is taken numerically.
    """
    log = log_of(HOLE + SPECIES.format(2, 3, 1, 0.1, "light", 1) + SPECIES.format(2, 5, 1, 0.1, "heavy", 4))
    speeds = [np.full(300, 2.0), np.full(100, 1.0)]  # of an energy of 2 each
    rates, time = [Theory(0.002, 0.0, "")] * 2, np.linspace(0, 2000, 257)
    paces, (mean, variance, error) = _expected(log, speeds, rates, time, 1000)
    pace = math.sqrt(math.pi * 2 / 2)
    assert [rate.value for rate in paces] == pytest.approx([0.002 * pace, 0.001 * pace], rel=1e-12)
    light, heavy = mean[0] / 300, mean[1] / 100
    assert light == pytest.approx(heavy**2, abs=4e-6)  # of a solver whose steps are exact to 1e-6
    x = np.linspace(heavy[-1], 1, 100001)
    duration = np.trapezoid(1 / (x * 0.001 * pace * ((300 * x**2 + 100 * x) / 400) ** 0.25), x)
    assert duration == pytest.approx(2000, abs=4e-6 / (0.001 * pace * x[0] ** 1.5))  # of x over its least rate
    assert heavy[-1] < 0.2
    assert variance == pytest.approx(mean * (1 - mean / [[300], [100]]), rel=1e-12)
    assert not error.any()
    with pytest.raises(ValueError, match="neither keep their speeds nor reach equilibrium"):
        _expected(log, speeds, rates, time, 15)  # enough for equal masses, but a collision passes on 16/25 at most


def test_fast_discs_leave_first():
    """The ratio of the rates then changes with time, and has no theory."""
    discs = ((3, 1, "a"), (4, 2, "a"), (5, 1.5, "b"))
    result = measured(HOLE + "".join(SPECIES.format(2, y, v, 0.1, name, 1) for y, v, name in discs))
    assert result.expected is not None
    assert result.species["b"].ratio.theory is None
    assert result.caveats[-1] == "Theory for the ratios is not available: the fast discs of each species leave first."


def test_a_species_of_which_no_disc_escapes():
    text = SPECIES.format(2, 4, 1, 0.1, "a", 1) + SPECIES.format(2, 1, 1, 0.1, "b", 1)
    result = measured(HOLE + text)
    assert (result.species["b"].escaped, result.species["b"].ratio) == (0, None)
    rate = result.species["b"].per_path
    assert rate.value == 0
    assert rate.standard_error == pytest.approx(math.sqrt(rate.theory / 12), rel=1e-12)  # of the expected number / 12
    assert rate.deviation == pytest.approx(-rate.theory / math.hypot(rate.standard_error, rate.theory_error))
    rows = [name for name, *_ in result.tables()[0].rows]
    assert rows == ["a: escapes per path (1/length)", "a: mean escape time (time)", "b: escapes per path (1/length)"]
    assert result.as_dict()["species"]["b"]["mean_time"]["value"] is None
    assert len(result.figure().axes) == 1
    opening = measured(HOLE.replace("absorbing = true", "absorbing = true, opens_at = 11") + text)
    rate = opening.species["b"].per_path
    assert (rate.theory, rate.standard_error) == (None, pytest.approx(1 / 12, rel=1e-12))  # of one escape


def test_a_species_at_rest_has_no_rate():
    text = SPECIES.format(2, 4, 1, 0.1, "a", 1) + SPECIES.format(2, 1, 0, 0.1, "b", 1)
    result = measured(HOLE + text)
    assert result.species["b"].per_path is None
    assert [name for name, *_ in result.tables()[0].rows if name.startswith("b")] == []


def test_a_species_that_never_reaches_the_hole_differs_from_theory():
    """Disc a flies into the hole; the twelve discs b fly above and below it, 12 · 12 · 30 long in total."""
    narrow = HOLE.replace("[9, 2]", "[9, 3.8]").replace("[9, 6]", "[9, 4.2]") + "interactions.discs = false\n"
    places = [(x, y) for x in (2, 5) for y in (0.5, 1, 1.5, 6.5, 7, 7.5)]
    discs = [SPECIES.format(2, 4, 1, 0.1, "a", 1)] + [SPECIES.format(x, y, 30, 0.1, "b", 1) for x, y in places]
    result = measured(narrow + "".join(discs))
    expected = (0.8 + 0.2 * math.pi) / (math.pi * (9.8 * 7.8 - 0.08 - math.pi * 0.01)) * 12 * 12 * 30
    error = (0.8 + 0.2 * math.pi) / (2 * (9.8 + 7.8) + 0.8 + 0.2 * math.pi) * expected
    deviation = -expected / math.hypot(math.sqrt(expected), error)
    assert result.species["b"].per_path.deviation == pytest.approx(deviation, rel=1e-6)
    sigma = f"{deviation:.1f}σ".replace("-", "−")
    assert f"; 1 of 2 differs from theory (largest deviation {sigma}, species 'b')." in result.summary()
