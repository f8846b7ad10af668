"""Coarse cells of discs that are far larger than the others."""

import numpy as np
import pytest
from helpers.log_compare import differences
from helpers.rounding import body
from helpers.support import record, same_rows

from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.cells import make_levels, own_cells
from idealgas.engine.event_driven.method import EventDriven, expected_threads
from idealgas.engine.simulation import Simulation, Stop
from idealgas.initial.build import make_gas
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

BOX = "[box]\nsize = [2, 1.5]\n"
DISCS = """
[run]
events = 2000
[[species]]
name = "small"
count = 150
radius.uniform = [0.005, 0.01]
mass.density = 1000
temperature = 1
[[species]]
name = "large"
count = 3
radius.values = [0.2, 0.1, 0.15]
mass = 10
temperature = 1
"""
SIDES = "".join(f"{side} = 'periodic'\n" for side in ("left", "right", "bottom", "top"))
SCENES = {
    "reflecting": BOX + DISCS,
    "periodic": BOX + SIDES + DISCS,
    "periodic along x": BOX + SIDES.split("bottom")[0] + DISCS,
    "walls and gravity": BOX
    + DISCS
    + "[[wall]]\nfrom = [0.3, 1]\nto = [1.2, 1.2]\n[gravity]\nacceleration = [0, -1]\n",
    "rotation and losses": BOX + DISCS + "[rotation]\nroughness = 0.5\n[restitution]\nnormal = 0.95\n",
    "piston": BOX + DISCS.replace("events", "until = 3\nevents") + "[[piston]]\nvelocity = -0.01\n",
    "thermostat": BOX + SIDES + DISCS + "[thermostat]\ntemperature = 1\nrate = 1\n",
}

QUICK = ("reflecting", "periodic")


@pytest.mark.interpreted
def test_only_discs_that_are_far_larger_have_coarse_cells():
    radius = np.full(4001, 0.006)
    assert make_levels(radius, (4.0, 4.0), 0.4)[1] is None
    radius[7] = 0.5
    fine, coarse = make_levels(radius, (4.0, 4.0), 0.4)
    assert (coarse.cells.columns, coarse.cells.rows) == (9, 9)  # seven cells, each wider than 0.506, and the ring
    assert fine.columns - 2 == 7 * coarse.ratio
    assert fine.width * coarse.ratio == pytest.approx(coarse.cells.width)
    assert fine.width >= 0.012
    assert 0.006 < coarse.limit < 0.5
    for r, cells in ((0.006, fine), (coarse.limit, fine), (0.5, coarse.cells)):
        assert own_cells(fine, coarse, body(r=r)) is cells
    assert own_cells(fine, None, body(r=0.5)) is fine
    assert fine.link is coarse.cells.link
    wide, narrow = (make_levels(radius, (side, side), 0.4)[1].cells for side in (4.04, 4.07))
    assert (wide.columns, narrow.columns) == (9, 10)  # eight cells of 0.506 need 4.048
    assert make_levels(np.linspace(0.004, 0.008, 4000), (4.0, 4.0), 0.4)[1] is None


def test_the_log_is_that_of_brute_force_whatever_the_cells():
    gas, stop = make_gas(parse_scene(SCENES["reflecting"])), Stop(events=2000)
    oracle = record(Simulation(gas, BruteForce()), stop)
    for filling, ratio in ((0.02, 10), (0.2, 3), (2.0, 1)):
        assert make_levels(gas.radius, gas.box, filling)[1].ratio == ratio
        assert same_rows(record(Simulation(gas, EventDriven(filling)), stop), oracle), filling


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in SCENES]
)
def test_the_log_is_that_of_brute_force(name, tmp_path):
    for method in ("event_driven", "brute_force"):
        scene = parse_scene(SCENES[name], overrides=[f"run.method = '{method}'"])
        simulate(scene, tmp_path / f"{method}.h5")
    assert set(differences(tmp_path / "event_driven.h5", tmp_path / "brute_force.h5")) <= {"scene"}
    gas = make_gas(scene)
    assert make_levels(gas.radius, gas.box, 0.4)[1] is not None
    wide = "the largest discs reach over many rows of cells"
    assert expected_threads(gas, 2, piston=False, shear=False)[:2] == (1, wide)
    assert expected_threads(gas, 2, piston=True, shear=False)[:2] == (1, "any disc may meet the piston")
    far = "any disc may meet others through sheared sides"
    assert expected_threads(gas, 2, piston=False, shear=True)[:2] == (1, far)
