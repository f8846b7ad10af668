"""Rounding changes energy and momentum at random, without a trend, where exact motion conserves them.

A trend would arise from contacts at a distance whose square is near a power of two: the square is rounded to a grid
that is twice as fine on one side. (Radii of 0.25 and 1 give the digits of 0.5.) The mean change per event is compared
with its standard error, from blocks of events of independent gases; k = 4.
"""

import math

import numpy as np
import pytest

from idealgas.engine.simulation import Simulation, Stop
from idealgas.initial.build import make_gas
from idealgas.run.effects import make_effects
from idealgas.run.simulate import method_of
from idealgas.scene import parse_scene

SIDES = "left", "right", "bottom", "top"
KINDS = {
    "walls": [],
    "periodic": [f"box.{side}='periodic'" for side in SIDES],
    "gravity": ["gravity.acceleration=[0.0, -1.0]"],
    "lossless": ["restitution={normal=1.0, wall=1.0}"],
    "rough": ["rotation={roughness=1.0, wall_roughness=1.0}"],
    "slanted": ["wall=[{from=[0.0, 0.4], to=[0.5, 0.0]}, {from=[0.6, 0.0], to=[1.2, 0.2]}]"],
    "slanted, rough": [
        "wall=[{from=[0.0, 0.4], to=[0.5, 0.0]}, {from=[0.6, 0.0], to=[1.2, 0.2]}]",
        "rotation={roughness=1.0, wall_roughness=1.0}",
    ],
}
GAS = """
box.size = [{side}, {side}]
species = [
    {{name = "a", count = {a}, radius = {radius}, mass = 1.0, temperature = 1.0}},
    {{name = "b", count = {b}, radius = {radius}, mass = {mass}, temperature = 1.0}},
]
run.events = 1
"""


def gas(kind, n, radius, mass, seed):
    """A gas at packing fraction 0.3, of which half the discs have another mass."""
    side = math.sqrt(n * math.pi * radius**2 / 0.3)
    text = GAS.format(side=side, a=n - n // 2, b=n // 2, radius=radius, mass=mass)
    scene = parse_scene(text, overrides=[f"scene.seed={seed}", *KINDS[kind]])
    start = make_gas(scene)
    return Simulation(start, method_of(scene, start), make_effects(scene, start))


def exact_sums(simulation):
    """Energy and momentum (px, py) at the time reached, summed without rounding."""
    state, effects = simulation.state()
    mass, position, velocity = state.mass, state.position, state.velocity
    energy = [0.5 * mass * component**2 for component in velocity.T]
    if effects.gravity is not None:
        energy.append(-mass * effects.gravity.y * position[:, 1])
    if effects.rotation is not None:
        energy.append(0.5 * effects.rotation.inertia * effects.rotation.omega**2)
    return [math.fsum(np.concatenate(energy)), *(math.fsum(mass * component) for component in velocity.T)]


def trend(kind, n, radius, mass, seeds, collisions, blocks=20):
    """Mean change per event of energy and momentum of one disc, and its standard error, each relative to a disc's own.

    Returns two arrays (3,): energy and momentum (x, y), in units of E/N and of √(2E/N).
    """
    changes = []
    for seed in seeds:
        simulation = gas(kind, n, radius, mass, seed)
        sums = [exact_sums(simulation)]
        for block in range(1, blocks + 1):
            simulation.run(Stop(events=block * collisions // blocks))
            sums.append(exact_sums(simulation))
        actual = sums[0][0] / n
        changes += list(
            np.diff(sums, axis=0) / [actual, math.sqrt(2 * actual), math.sqrt(2 * actual)] * blocks / collisions
        )
    return np.mean(changes, axis=0), np.std(changes, axis=0, ddof=1) / math.sqrt(len(changes))


CASES = [
    *((kind, n, radius, 1.0) for kind, n in (("walls", 2), ("walls", 10), ("periodic", 10)) for radius in (0.45, 0.5)),
    *((kind, 10, 0.5, 1.0) for kind in ("gravity", "lossless", "rough", "slanted", "slanted, rough")),
    *((kind, 10, 0.5, 0.1) for kind in ("walls", "periodic", "rough")),
]


def check(case, seeds, collisions):
    mean, error = trend(*case, seeds, collisions)
    tested = slice(None) if case[0] == "periodic" else slice(1)  # walls take momentum
    assert (np.abs(mean)[tested] < 4 * error[tested]).all(), (mean, error)
    return mean, error


@pytest.mark.parametrize(
    "case",
    [pytest.param(case, marks=[pytest.mark.slow] if case[0] == "slanted, rough" else []) for case in CASES],
    ids=str,
)
def test_no_trend_by_rounding(case):
    check(case, range(1, 5), 200_000)


@pytest.mark.long
@pytest.mark.parametrize(
    "case", [*CASES, *((kind, 1000, 0.5, 1.0) for kind in ("walls", "periodic", "rough"))], ids=str
)
def test_no_trend_in_long_runs(case):
    check(case, range(1, 9), 1_000_000)
