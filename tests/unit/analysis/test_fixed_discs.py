"""A gas among discs so heavy that they stay where they are: the light ones have all energy, the others no theory."""

import math

import pytest
from helpers.logs import PERIODIC

from idealgas import histogram
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.temperature import temperature

GAS = """
scene.seed = 2
box.size = [12, 12]
disc = [
    { position = [3, 3], radius = 1, mass = 1e16, species = "fixed" },
    { position = [9, 3], radius = 1, mass = 1e16, species = "fixed" },
    { position = [6, 9], radius = 1.5, mass = 1e30, species = "huge" },
]
species = [{ name = "light", count = 20, radius = 0.2, temperature = 1 }]
run.collisions_per_disc = 300
"""


@pytest.mark.parametrize("sides", [(), PERIODIC], ids=["walls", "periodic"])
def test_light_discs_among_fixed_ones(make, sides):
    """Elastic scatterers conserve the energy of the light discs, E/N = 1; four standard errors."""
    log = make(*sides)
    result = temperature(log)
    names = [entry.species for entry in result.species]
    assert names == ["fixed", "huge", "light", "all discs"]
    assert result.window.detected
    light = result.species[2]
    for estimate in (light.x, light.y):
        assert estimate.theory == pytest.approx(1, rel=1e-9)
        assert estimate.standard_error < 0.1
        assert abs(estimate.deviation) < 4
    for entry in result.species[:2]:
        assert entry.both.theory is None
        assert entry.both.value < 1e-9
    assert math.isfinite(pressure(log).collision_rates[0].rate.value)
    *fixed, light = histogram(log, "speed").distributions
    assert [len(each.tests) for each in fixed] == [0, 0]
    assert light.tests[-1].law_name == "fixed energy (40 degrees of freedom)"
    assert light.tests[-1].p_value > 0.001
