"""Flow through a gate: discs that pass it by hand, the law of two chambers, and where there is none."""

import math

import numpy as np
import pytest
from helpers.logs import log_of, raised

from idealgas.analysis.effusion import INSTANTS, EffusionAnalysis, _no_law, _share_beyond

pytestmark = [pytest.mark.interpreted, pytest.mark.usefixtures("uncompiled")]

SCENE = """
box.size = [20, 10]
wall = [
    { from = [8, 0], to = [8, 4] }, { from = [8, 6], to = [8, 10] }, { from = [8, 4], to = [8, 6], opens_at = 1 },
]
run.until = 9
disc = [
    { position = [3, 5], velocity = [1, 0], radius = 0.1 },
    { position = [3, 2], velocity = [0, 2], radius = 0.1 },
    { position = [14, 2], velocity = [0, 1], radius = 0.1 },
]
"""


def measured(text=SCENE, **window):
    return EffusionAnalysis.measure(log_of(text), **window)


@pytest.mark.parametrize("turned", [False, True])
def test_one_disc_passes(turned):
    """The first of two disc comes to the slit, 1.8 wide for the centres, at t = 5; the third is beyond from the start.

    Of an energy 3 and six degrees of freedom T = 1 and ⟨v⟩ = √(π/2) √3 Γ(3)/Γ(3.5). Speeds of 3 before, then 2, are on
    one side, in the area 7.8 · 9.8, and of 1, then 2, on the other, in 11.8 · 9.8.
    """
    text = SCENE
    if turned:  # the same from right to left, where the chamber with more discs is on the right
        for a, b in (("[8, ", "[12, "), ("[3, ", "[17, "), ("[14, ", "[6, "), ("velocity = [1,", "velocity = [-1,")):
            text = text.replace(a, b)
    result = measured(text)
    mean_speed = math.sqrt(math.pi / 2) * math.sqrt(3) * 2 / math.gamma(3.5)
    time = np.linspace(1, 9, INSTANTS)
    passed = time > 5
    there = (3.0 - passed) / mean_speed / (7.8 * 9.8)
    back = (1.0 + passed) / mean_speed / (11.8 * 9.8)
    drive, both = np.trapezoid(there - back, time), np.trapezoid(there + back, time)
    assert result.time == pytest.approx(time)
    assert result.beyond.tolist() == (1 + passed).tolist()
    assert result.speed.value == pytest.approx(1 / (1.8 * drive), rel=1e-12)
    expected = mean_speed / math.pi
    assert result.speed.theory == pytest.approx(expected, rel=1e-12)
    assert result.speed.standard_error == pytest.approx(math.sqrt(expected * 1.8 * both) / (1.8 * drive), rel=1e-12)
    assert (result.density, result.temperature) == (pytest.approx(3 / (7.8 * 9.8)), pytest.approx(1.0))
    density = 2 / (7.8 * 9.8)
    phi = math.pi * 0.01 * density
    paths = 1.8 * 2 * math.sqrt(2) * 0.2 * density * (1 - 7 * phi / 16) / (1 - phi) ** 2
    error = expected * (0.0125 + 0.245 * paths + 3.2 * phi)
    assert result.speed.theory_error == pytest.approx(error, rel=1e-12)
    assert result.expected[0] == pytest.approx(1.0)
    slope = np.diff(result.expected[:2])[0] / np.diff(time[:2])[0]
    assert slope == pytest.approx(expected * 1.8 * (2 / (7.8 * 9.8) - 1 / (11.8 * 9.8)), rel=1e-3)  # at equal T
    assert result.caveats == ()


def test_windows_are_those_of_the_open_gate():
    closing = SCENE.replace("opens_at = 1", "opens_at = 1, closes_at = 7")
    assert measured(closing, start=2.0).time[[0, -1]].tolist() == [2.0, 7.0]
    raised("the gate is open only from t = 1 to 7", measured, closing, start=8.0)
    wide = SCENE.replace("[8, 4]", "[8, 0.05]").replace("[8, 6]", "[8, 9.95]")
    raised("the gate opens the box from side to side", measured, wide)
    raised("there is a gap of 1 beside the gate", measured, SCENE.replace("to = [8, 4] }, ", "to = [8, 3] }, "))


def test_two_chambers_become_even():
    """To order t: leave · n - come · m; and in the end as many by volume, of one temperature."""
    time = np.linspace(0, 1000, 257)
    share = _share_beyond(time, 0.2, 0.03, 0.01)
    assert share[0] == 0.2
    assert share[-1] == pytest.approx(0.03 / 0.04, rel=1e-5)
    early = _share_beyond(np.linspace(0, 0.01, 3), 0.2, 0.03, 0.01)
    assert early[-1] - 0.2 == pytest.approx(0.01 * (0.03 * 0.8 - 0.01 * 0.2), rel=1e-3)
    into_vacuum = _share_beyond(np.linspace(0, 20, 3), 0.0, 0.03, 0.0)
    assert 1 - into_vacuum == pytest.approx((1 + 0.03 * np.array([0, 10, 20]) / 4) ** -4.0, rel=1e-6)  # as it cools


def test_where_the_law_ends():
    assert len(_no_law(1.0, 0.03)) == 0
    assert "mean free paths wide" in _no_law(1.01, 0.03)[0]
    assert "packing fraction" in _no_law(1.0, 0.031)[0]
