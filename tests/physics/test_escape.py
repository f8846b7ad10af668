"""Escape through a small hole: the exact rate of an ergodic box, with and without collisions, and what is refused.

A disc of speed v meets a hole of the length ℓ in the wall around an area A at the mean rate v ℓ/(π A), as the mean free
path of a billiard is π A/P (Chernov & Markarian, Chaotic Billiards (2006), section 2.12). Allowed are 4 standard errors
of a Poisson number of escapes.
"""

import math

import numpy as np
import pytest
from helpers.logs import gas, log_of, raised
from helpers.support import ROOT

from idealgas import escape
from idealgas.analysis.escape import BILLIARD

ROUND = """
scene.seed = 2
box.size = [10, 10]
run.until = {until}
wall = [
    {{ solid = "outside", from = [0, 5], to = [9.975, 5.5], via = [5, 10] }},
    {{ solid = "outside", from = [9.975, 5.5], to = [9.975, 4.5], via = [10, 5], absorbing = true }},
    {{ solid = "outside", from = [9.975, 4.5], to = [0, 5], via = [5, 0] }},
]
species = [{{ name = "gas", count = {count}, radius = {radius}, temperature = 2, mass = 3 }}]
"""


def escape_of(scene, *overrides):
    return escape(log_of(scene, *overrides))


def assert_number_left(result):
    """Of all times, a tenth apart."""
    deviations = (result.left - result.expected)[::26] / np.maximum(result.spread[::26], 1)
    assert np.abs(deviations).max() < 4


def test_the_shipped_box_has_the_exact_rate():
    """All at the speed 1: 1.5 mean escape times of 1 500 discs, of which 1 165 leave; 3 % of the rate."""
    result = escape_of("escape", "species.count=1500", "run.until=660")
    assert result.per_path.theory == pytest.approx(0.3 / (math.pi * 42.1984), rel=1e-5)
    assert result.mean_time.theory == pytest.approx(1 / result.per_path.theory, rel=1e-12)
    assert abs(result.per_path.deviation) < 4
    assert abs(result.mean_time.deviation) < 4
    assert_number_left(result)
    assert result.escaped == 1500 - result.left[-1]
    assert result.caveats == (BILLIARD,)


def test_a_gas_that_cools_as_it_escapes():
    """The fast ones leave first: T ∝ √N, and N ∝ (1 + t/4τ)⁻⁴, which is 8 standard deviations from an exponential."""
    result = escape_of(ROUND.format(until=1500, count=400, radius=0.02))
    assert abs(result.per_path.deviation) < 4
    assert_number_left(result)
    tau = 1 / (result.per_path.theory * math.sqrt(math.pi * 2 / (2 * 3)))
    exponential = 400 * math.exp(-1500 / tau)
    assert result.left[-1] - exponential > 8 * math.sqrt(exponential)
    assert result.caveats == ()


def test_grahams_law_in_a_mixture_that_cools():
    """Species of masses 1 and 4: √(1/4), with a part in 1000 from their radii; equal rates are excluded."""
    heavy = ', { name = "heavy", count = 300, radius = 0.012, temperature = 2, mass = 4 }]'
    scene = ROUND.format(until=400, count=300, radius=0.006).replace(", mass = 3 }]", " }" + heavy)
    result = escape_of(scene)
    for part in (*result.species.values(), result):
        assert_number_left(part)
    assert max(abs(part.per_path.deviation) for part in result.species.values()) < 4
    ratio = result.species["heavy"].ratio
    assert ratio.theory == pytest.approx(0.5, rel=3e-3)
    assert abs(ratio.deviation) < 4
    assert ratio.value < 1 - 5 * math.hypot(ratio.standard_error, ratio.theory_error)
    assert result.caveats == ()


@pytest.mark.usefixtures("uncompiled")
def test_lengths_and_areas_are_those_of_the_centres():
    """In a circle of radius 5: π (5 - R)² and (5 - R) of the angle of the hole, whose chord is 1."""
    result = escape_of(ROUND.format(until=50, count=30, radius=0.25))
    angle, reach = 2 * math.asin(0.5 / 5), 5 - 0.25
    assert result.per_path.theory == pytest.approx(angle * reach / (math.pi * math.pi * reach**2), rel=1e-3)


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize(
    ("until", "wall", "length", "area"),
    [
        (5, "from = [4, 5], to = [4, 5], via = [6, 5], solid = 'inside'", 2 * math.pi * 1.2,
         (10 - 0.4) ** 2 - math.pi * 1.2**2 - 4 * 0.2**2),
        (20, "from = [4, 0.001], to = [6, 0.001]", 2 + 2 * 0.2 * math.acos(0.199 / 0.2), 9.6**2),
    ],
    ids=["a round trap", "just inside a side"],
)  # fmt: skip
def test_a_hole_in_a_box(until, wall, length, area):
    """A trap has the circumference 2π (1 + R) for the centres, and the area is that of box less trap.

    Discs reach the other hole from above only, and do not reach the side behind it: A = (10 - 2R)². On the way along
    the side a disc touches an end of the hole R sin α before it is above it, cos α = (R - 0.001)/R.
    """
    result = escape_of(gas(30, 0.2, (10, 10), f"until = {until}"), f"wall=[{{ {wall}, absorbing = true }}]")
    assert result.per_path.theory == pytest.approx(length / (math.pi * area), rel=2e-3)


@pytest.mark.usefixtures("uncompiled")
def test_speeds_that_walls_or_a_heat_bath_change():
    """Discs that hardly ever collide: the rate per path is known, but neither the number left nor the mean time."""
    scene = ROUND.format(until=200, count=10, radius=1e-6).replace("temperature = 2", "speed = 1")
    result = escape_of(scene + "[thermostat]\ntemperature = 2\nrate = 0.1")
    assert result.per_path.theory is not None
    assert result.expected is None
    assert result.mean_time.theory is None
    reason = "walls or a heat bath change the speeds of discs that hardly ever collide"
    assert f"Theory for the number of remaining discs is not available: {reason}." in result.caveats


@pytest.mark.usefixtures("uncompiled")
def test_what_has_no_theory():
    scene = ROUND.format(until=12, count=25, radius=0.2)
    gate = scene.replace('solid = "outside", ', "").replace("absorbing = true", "absorbing = true, opens_at = 11")
    result = escape_of(gate)
    assert result.per_path.theory is None
    assert result.caveats == ("Theory is not available: a hole opens or closes, or lets discs pass.",)
    both = log_of(scene, "species.gas.radius={ values = [0.1, 0.2] }")
    assert escape(both).caveats == ("Theory is not available: the discs differ in radius.",)
    raised(r"no disc leaves the gas between t = 0 and 0\.001", escape, both, end=0.001)


@pytest.mark.slow
def test_falling_discs_have_no_path():
    result = escape_of(ROUND.format(until=20, count=40, radius=0.2), "gravity.acceleration=[0, -0.1]")
    assert result.per_path is None
    assert result.mean_time.value > 0
    assert result.caveats == ("Theory is not available: gravity acts on the discs, or walls move.",)


@pytest.mark.slow
def test_a_free_wall_also_catches_discs_at_its_ends():
    """In a chaotic box ℓ = 2L + 2πR of a wall of length L, here 1.73 · 2L."""
    walls = (ROOT / "configs" / "escape.toml").read_text().replace("absorbing = true, ", "")
    trap = "    { from = [5.3, 4.9], to = [5.35, 4.9], absorbing = true },\n]\n\n[scene]"
    result = escape_of(walls.replace("]\n\n[scene]", trap), "species.radius=0.0116", "run.until=1200")
    length = 0.1 + 2 * math.pi * 0.0116
    assert result.per_path.theory == pytest.approx(length / (math.pi * 41.85), rel=2e-3)
    assert result.per_path.standard_error < 0.04 * result.per_path.value
    assert result.per_path.theory_error < 0.08 * result.per_path.theory
    assert abs(result.per_path.deviation) < 4
    assert_number_left(result)
