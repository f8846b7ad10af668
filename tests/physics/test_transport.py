"""Viscosity and heat conductivity of periodic gases against Enskog's theory, from the events of several runs.

Minutes for each state; run by hand.
"""

import math

import pytest

from idealgas.analysis.core.statistics import Estimate, mean_of_replicates
from idealgas.analysis.transport.measure import Transport, transport
from idealgas.log import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

STANDARD_ERRORS = 3
"""Largest difference between two directions, in its standard errors."""

RESOLVED = 0.015
"""Largest standard error of a coefficient, relative."""


def measure(path, number: int, phi: float, seed: int, collisions_per_disc: int) -> Transport:
    sides = ", ".join(f'{side} = "periodic"' for side in ("left", "right", "bottom", "top"))
    radius = math.sqrt(phi / (number * math.pi))
    gas = f'name = "gas", count = {number}, radius = {radius!r}, temperature = 1, placement = "lattice"'
    scene = f"""
        scene.seed = {seed}
        box = {{size = [1, 1], {sides}}}
        species = [{{{gas}}}]
        log.compression = "none"
        run.collisions_per_disc = {collisions_per_disc}
    """
    simulate(parse_scene(scene), path, force=True)
    with open_log(path) as log:
        return transport(log, start=log.end_time / 100)


def over_theory(found: list[Estimate]) -> Estimate:
    return mean_of_replicates([one.times(1 / one.theory) for one in found])


@pytest.mark.long
@pytest.mark.parametrize(
    ("phi", "number", "runs", "within"),
    [
        (0.01, 1000, 12, 0.02),
        *((phi, 250, 8, 0.05) for phi in (0.05, 0.1, 0.2)),
        (0.3, 250, 8, 0.08),
        (0.4, 250, 8, 0.08),
    ],
)
def test_enskog(tmp_path, phi, number, runs, within):
    found = [measure(tmp_path / "run.h5", number, phi, seed, 20_000).collective for seed in range(runs)]
    for name in ("viscosity", "heat_conductivity"):
        ones = [one.coefficients[name] for one in found]
        ratio = over_theory([one.value for one in ones])
        print(f"φ = {phi}, N = {number}: {name} over Enskog's {ratio.value:.4f} ± {ratio.standard_error:.4f}")
        assert ratio.standard_error < RESOLVED
        assert abs(ratio.value - 1) < within
        apart = mean_of_replicates([one.difference for one in ones])
        assert abs(apart.value) < STANDARD_ERRORS * apart.standard_error
