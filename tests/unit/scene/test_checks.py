"""Bounds of checks between tables: the last value that is accepted and the first that is refused, and which it is."""

import math
import re

import pytest
from helpers.support import refused

from idealgas.scene import parse_scene

pytestmark = pytest.mark.interpreted

ALONE = """
box = { size = [4, 4], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic" }
disc = [{ position = [2, 2], velocity = [2, 0], radius = 0.5 }]
"""
GAS = 'species = [{{ name = "gas", count = {}, radius = {}, temperature = 1 }}]\nrun.until = 1\n'
HEAT = 'log = { pressure = true, heat_flow = true }\nbox = { size = [10, 10], left = "periodic", right = "periodic"'


def limit(free, speed):
    """2⁵² mean free times of a disc that only passes sides this far apart, less its diameter, at π/4 of them."""
    return 2.0**52 * math.pi / 4 * free / speed


def halves(count, other):
    """Discs of radius 0.1, some of them in the right half of a box of 10 by 10."""
    return (
        f'box.size = [10, 10]\nrun.until = 1\nspecies = [{{ name = "a", count = {count}, radius = 0.1, speed = 1 }}, '
        f'{{ name = "b", count = {other}, radius = 0.1, speed = 1, region = [5, 0, 10, 10] }}]\n'
    )


def solids(*curves, number=1):
    """Polygons of walls, from their corners."""
    rows = [
        f'{{ solid = "inside", from = {list(a)}, to = {list(b)} }}'
        for corners in curves
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)
    ]
    return f"box.size = [10, 10]\nwall = [{', '.join(rows)}]\n" + GAS.format(number, 0.1)


NINE = "box.size = [9, 9]\n"
TWO = GAS.format(2, 0.1)
BATH = "thermostat = {{ temperature = 1, rate = {} }}\n"
SQUARE, BLOCK = ((2, 2), (4, 2), (4, 4), (2, 4)), ((2, 2), (8, 2), (8, 8), (2, 8))


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        pytest.param(ALONE + f"run.until = {0.999 * limit(3, 2):g}", None, id="clock"),
        pytest.param(ALONE + f"run.until = {1.001 * limit(3, 2):g}", "too long for the resolution", id="clock+"),
        pytest.param("box.size = [10, 1]\n" + GAS.format(1, 1.01e-8), None, id="small"),
        pytest.param("box.size = [10, 1]\n" + GAS.format(1, 0.99e-8), "too small for the box", id="small-"),
        pytest.param("box.size = [2, 1]\n" + GAS.format(1, 0.5), None, id="wide"),
        pytest.param("box.size = [2, 1]\n" + GAS.format(1, 0.501), "wider than the box", id="wide+"),
        pytest.param(halves(1100, 960), None, id="whole"),  # 0.647 of it
        pytest.param(halves(1120, 960), r"discs for the box \(got packing fraction 0\.6535", id="whole+"),
        pytest.param(halves(1, 1030), None, id="region"),
        pytest.param(halves(1, 1040), r"discs for the region \(got packing fraction 0\.6535", id="region+"),
        pytest.param(solids(BLOCK, number=1310), None, id="free"),  # 0.643 of the 64 that a solid leaves
        pytest.param(solids(BLOCK, number=1340), r"for the box \(got packing fraction 0\.6578", id="free+"),
        pytest.param(HEAT + ', bottom = "periodic", top = "periodic" }\n' + GAS.format(20, 0.1), None, id="heat"),
        pytest.param(HEAT + " }\n" + GAS.format(20, 0.1), "walls exchange heat and momentum with the gas", id="heat-"),
        pytest.param(solids(SQUARE, ((4, 3), (6, 2), (6, 4))), None, id="a corner on a side"),
        pytest.param(solids(SQUARE, ((3.9, 3), (6, 2), (6, 4))), "curves that cross", id="a corner in it"),
        pytest.param(solids(SQUARE, ((4, 4), (6, 4), (6, 6))), "curve not closed", id="a corner on a corner"),
        pytest.param(NINE + "run.trials = 1\n" + TWO, "no trials in event_driven", id="owner"),
        pytest.param(NINE + "log.snapshot_every = 1.01e-7\n" + TWO, None, id="snapshots"),
        pytest.param(NINE + "log.snapshot_every = 0.99e-7\n" + TWO, "too many snap", id="more"),
        pytest.param(NINE + BATH.format("4.99e9") + TWO, None, id="bath"),
        pytest.param(NINE + BATH.format("5.01e9") + TWO, "too many thermostat collisions", id="bath+"),
    ],
)
def test_bounds_of_scenes(text, wrong):
    if wrong is None:
        parse_scene(text)
    else:
        assert re.search(wrong, "\n".join(refused(text)))
