"""Sound of a large gas against what the other analyses measure: pressure, viscosities and thermal conductivity."""

import numpy as np
import pytest

from idealgas import sound
from idealgas.analysis.core.statistics import mean_of_replicates
from idealgas.analysis.transport.measure import transport
from idealgas.scene import parse_scene

SIDE, NUMBER, SEEDS = 80.0, 2400, range(1, 7)
GAS = f"""
box = {{size = [{SIDE}, {SIDE}], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic"}}
species = [{{name = "gas", count = {NUMBER}, radius = 0.5, temperature = 1}}]
run.until = 6400
log.compression = "none"
"""


@pytest.mark.long
def test_the_chain_agrees_with_itself(run):
    """Speed within 2 % of the equation of state's, damping within 10 % of what the coefficients give, and 4 s.e."""
    waves, chain = [], []
    density = NUMBER / SIDE**2
    for seed in SEEDS:
        log = run(parse_scene(GAS, overrides=[f"scene.seed={seed}"]))
        waves.append(sound(log).waves[0])
        currents = transport(log, end=1500.0).collective.coefficients
        found = {name: current.value.value for name, current in currents.items()}
        gamma = waves[-1].exponent.theory
        heat = found["thermal_conductivity"] / (density * gamma)
        chain.append(((found["viscosity"] + found["bulk_viscosity"]) / density + (gamma - 1) * heat) / 2)
    speed, damping = (mean_of_replicates([getattr(wave, name) for wave in waves]) for name in ("speed", "damping"))
    assert speed.standard_error < 0.005 * speed.value
    assert abs(speed.value / speed.theory - 1) < 0.02
    assert damping.standard_error < 0.05 * damping.value
    assert abs(damping.value / np.mean(chain) - 1) < 0.1 + 2 * damping.standard_error / damping.value
