"""Flow through a gate: discs that pass it by hand, the law of two chambers, and where there is none."""

import json
import math

import numpy as np
import pytest
from helpers.logs import log_of, raised

from idealgas.analysis.effusion import INSTANTS, Effusion, EffusionAnalysis, _no_law, share_beyond
from idealgas.fields import from_dict

pytestmark = pytest.mark.usefixtures("uncompiled")

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


def share_of_one(time, at_first, leave, come):
    (share,) = share_beyond(time, *(np.array([value]) for value in (at_first, leave, come, 1.0)))
    return share


def test_two_chambers_become_even():
    """To order t: leave · n - come · m; and in the end as many by volume, of one temperature."""
    time = np.linspace(0, 1000, 257)
    share = share_of_one(time, 0.2, 0.03, 0.01)
    assert share[0] == 0.2
    assert share[-1] == pytest.approx(0.03 / 0.04, rel=1e-5)
    early = share_of_one(np.linspace(0, 0.01, 3), 0.2, 0.03, 0.01)
    assert early[-1] - 0.2 == pytest.approx(0.01 * (0.03 * 0.8 - 0.01 * 0.2), rel=1e-3)
    into_vacuum = share_of_one(np.linspace(0, 20, 3), 0.0, 0.03, 0.0)
    assert 1 - into_vacuum == pytest.approx((1 + 0.03 * np.array([0, 10, 20]) / 4) ** -4.0, rel=1e-6)  # as it cools


def test_species_share_the_temperature_of_a_chamber():
    """Two names for equal discs change nothing; a lighter species passes first; all become even."""
    time, part = np.linspace(0, 2000, 257), np.array([0.75, 0.25])
    same = share_beyond(time, np.full(2, 0.2), np.full(2, 0.03), np.full(2, 0.01), part)
    assert same == pytest.approx(
        np.tile(share_of_one(time, 0.2, 0.03, 0.01), (2, 1)), abs=4e-6
    )  # of a solver whose steps are exact to 1e-6
    light, heavy = share_beyond(time, np.zeros(2), np.array([0.02, 0.01]), np.array([0.02, 0.01]), part)
    assert (light > heavy)[1:50].all()
    assert (light[-1], heavy[-1]) == pytest.approx((0.5, 0.5), rel=1e-4)
    assert 1 - 2 * light[1] == pytest.approx((1 - 2 * heavy[1]) ** 2, rel=0.01)  # at nearly one temperature


def test_where_the_law_ends():
    assert len(_no_law(1.0, 0.03)) == 0
    assert "mean free paths wide" in _no_law(1.01, 0.03)[0]
    assert "packing fraction" in _no_law(1.0, 0.031)[0]


MIXTURE = (
    SCENE[: SCENE.index("disc = [")]
    + """
disc = [
    { position = [3, 5], velocity = [1, 0], radius = 0.1, species = "small" },
    { position = [3, 2], velocity = [0, 2], radius = 0.1, species = "small" },
    { position = [13, 5], velocity = [-1.25, 0], radius = 0.3, mass = 4, species = "large" },
    { position = [14, 2], velocity = [0, 1], radius = 0.3, mass = 4, species = "large" },
]
"""
)


def test_species_pass_in_opposite_directions():
    """A small disc comes to the slit at t = 5, and a large disc from the other side at t = 4.

    Slits are 1.8 and 1.4 wide for the centres. The small discs have speeds of 3 on the left, then 2; the large discs
    have speeds of 2.25 on the right, then 1. The gas has an energy of 2.5 + 5.125 and eight degrees of freedom.
    """
    text = MIXTURE.replace("[3, 5], velocity = [1, 0]", "[3, 4.5], velocity = [1, 0]").replace("[13, 5]", "[13, 5.3]")
    result = measured(text)
    temperature = 2 * (2.5 + 2 * (1.25**2 + 1)) / 8
    assert result.temperature == pytest.approx(temperature, rel=1e-12)
    time = np.linspace(1, 9, INSTANTS)
    factor = math.sqrt(4) * math.gamma(4) / math.gamma(4.5)
    areas = {r: ((8 - 2 * r) * (10 - 2 * r), (12 - 2 * r) * (10 - 2 * r)) for r in (0.1, 0.3)}
    speeds = {}
    for name, r, mass, moment, number, passes in (
        ("small", 0.1, 1, 5, (3.0, 1.0), 1),
        ("large", 0.3, 4, 4, (2.25, 1.25), -1),
    ):
        flow, passed = result.species[name], time > moment
        mean_speed = math.sqrt(math.pi * temperature / (2 * mass)) * factor
        speeds[name] = mean_speed
        start, other = areas[r] if passes > 0 else areas[r][::-1]
        there, back = (number[0] - number[1] * passed) / start, number[1] * passed / other
        drive, both = (np.trapezoid(side, time) / mean_speed for side in (there - back, there + back))
        slit = 2 - 2 * r
        assert flow.speed.value == pytest.approx(1 / (slit * drive), rel=1e-12)
        assert flow.speed.theory == pytest.approx(mean_speed / math.pi, rel=1e-12)
        error = math.sqrt(mean_speed / math.pi * slit * both) / (slit * drive)
        assert flow.speed.standard_error == pytest.approx(error, rel=1e-12)
        assert flow.beyond.tolist() == ((passes < 0) * 2 + passes * passed).tolist()
        assert flow.density == pytest.approx(2 / start, rel=1e-12)
    assert (result.speed, result.density) == (result.species["small"].speed, result.species["small"].density)
    combined = EffusionAnalysis.combine([result])
    (ratio,) = combined.ratios.values()
    small, large = (flow.speed for flow in result.species.values())
    assert list(combined.ratios) == ["large / small"]
    assert ratio.value == pytest.approx(large.value / small.value, rel=1e-12)
    assert ratio.theory == pytest.approx(0.5, rel=1e-12)  # Graham
    assert ratio.standard_error == pytest.approx(
        math.hypot(large.standard_error, 0.5 * small.standard_error) / small.value
    )
    relative = max(speed.theory_error / speed.theory for speed in (small, large))
    assert ratio.theory_error == pytest.approx(0.5 * relative, rel=1e-12)
    assert combined.together == {"small": small, "large": large}
    assert combined.as_dict()["flows"]["large"]["beyond"] == result.species["large"].beyond.tolist()
    assert "Ratio of the rates large / small: " in combined.summary()
    assert len(combined.plain_tables()) == 2
    stored = from_dict(Effusion, json.loads(json.dumps(result.as_dict())))
    assert json.dumps(stored.as_dict()) == json.dumps(result.as_dict())


def test_runs_of_mixtures_are_averaged_by_species():
    runs = [
        measured(MIXTURE.replace("[3, 5], vel", f"[{x}, 4.5], vel").replace("[13, 5]", "[13, 5.3]")) for x in (3, 2)
    ]
    combined = EffusionAnalysis.combine(runs)
    for name, speed in combined.together.items():
        values = [run.species[name].speed.value for run in runs]
        assert speed.value == pytest.approx(np.mean(values), rel=1e-12)
        assert (
            combined.flows[name].beyond.tolist() == np.mean([run.species[name].beyond for run in runs], axis=0).tolist()
        )
    assert combined.figure().axes


@pytest.mark.parametrize("order", [1, -1])
def test_a_species_that_does_not_pass(order):
    """The large discs fly at the speed 1 beside the slit, 0.6 wide for them; their chamber is too dense for theory."""
    beside = MIXTURE.replace("[13, 5], velocity = [-1.25, 0]", "[17, 5], velocity = [0, 1]")
    *head, a, b, c, d, end = beside.replace("radius = 0.3", "radius = 0.7").splitlines()
    result = measured("\n".join([*head, *[a, b, c, d][::order], end]))
    temperature = 2 * (2.5 + 4) / 8
    mean_speed = math.sqrt(math.pi * temperature / 8) * math.sqrt(4) * math.gamma(4) / math.gamma(4.5)
    drive = 8 * 2 / mean_speed / (10.6 * 8.6)
    small, large = (result.species[name].speed for name in ("small", "large"))
    assert (large.value, large.theory) == (0, None)
    assert large.standard_error == pytest.approx(1 / (0.6 * drive), rel=1e-12)  # of one passage
    combined = EffusionAnalysis.combine([result])
    assert list(combined.flows) == ["small", "large"][::order]
    if order > 0:
        (ratio,) = combined.ratios.values()
        assert (ratio.value, ratio.standard_error) == (0, pytest.approx(large.standard_error / small.value))
    else:
        assert combined.ratios is None  # to species "large", which does not pass


def test_what_species_need():
    wide = MIXTURE.replace("radius = 0.3", "radius = 1.01")
    raised("requires a slit wider than a disc of species 'large'$", measured, wide)
    even = MIXTURE.replace("[14, 2], velocity = [0, 1], radius = 0.3", "[3, 8], velocity = [0, 1], radius = 0.3")
    even = even.replace("velocity = [-1.25, 0]", "velocity = [0, 1]")
    raised("requires unequal densities of species 'large' in the two chambers$", measured, even)
    raised("requires a slit wider than a disc$", measured, SCENE.replace("radius = 0.1", "radius = 1.01"))
