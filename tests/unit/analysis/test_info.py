"""What a log contains, as nested values."""

import json
import math
from types import SimpleNamespace

import numpy as np
import pytest
from helpers.logs import log_of

from idealgas.analysis.info import _reference_speed, info

pytestmark = pytest.mark.interpreted


def test_numbers_of_two_discs(lanes):
    result = info(lanes)
    gas, run = result["gas"], result["run"]
    assert (gas["box"], gas["number"], gas["common_motion"]) == ([10.0, 8.0], 2, [0.0, 0.0])
    assert gas["packing_fraction"] == pytest.approx(math.pi * (0.25 + 0.0625) / 80, rel=1e-14)
    assert (gas["kinetic_energy"], gas["temperature"]) == (3.75, 1.875)
    assert gas["species"] == [
        {"name": "a", "number": 1, "radius": 0.5, "mass": 2.0},
        {"name": "b", "number": 1, "radius": 0.25, "mass": 1.0},
    ]
    assert (run["start_time"], run["end_time"], run["event_rows"]) == (0.0, 180.0, len(lanes))
    assert run["event_columns"] == ["time", "disc", "partner", "kind", "position", "velocity"]
    assert run["walls"] == ["left", "right", "bottom", "top", "wall 4"]
    assert (result["file"]["bytes"], result["file"]["state"]) == (lanes.path.stat().st_size, "complete")
    assert (result["scene"]["seed"], result["scene"]["method"], "v_ref" in run) == (0, "event_driven", False)
    assert json.loads(json.dumps(result, allow_nan=False))


@pytest.mark.usefixtures("uncompiled")
def test_the_motion_of_the_whole_gas_is_not_in_its_temperature():
    """Masses 1 and 3 at (2, 1) and (2, -1): (2, -½), with 8.5 of the energy 10; and a piston that halves the room."""
    text = """
        box = { size = [10, 8], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic" }
        run.until = 0.5
        disc = [
            { position = [2, 6], velocity = [2, 1], radius = 0.5 },
            { position = [2, 2], velocity = [2, -1], radius = 0.5, mass = 3 },
        ]
    """
    gas = info(log_of(text))["gas"]
    assert gas["common_motion"] == [2.0, -0.5]
    assert (gas["kinetic_energy"], gas["temperature"]) == (10.0, 0.75)
    half = text.replace(', left = "periodic", right = "periodic", bottom = "periodic", top = "periodic"', "")
    piston = 'piston = [{ side = "right", position = 5, velocity = 0 }]\n'
    assert info(log_of(half + piston))["gas"]["packing_fraction"] == pytest.approx(math.pi * 0.5 / 40, rel=1e-14)
    fixed = half.replace("mass = 3 },", "mass = 3 }, { position = [7, 4], radius = 1, fixed = true },")
    assert info(log_of(fixed))["gas"]["packing_fraction"] == pytest.approx(math.pi * 0.5 / (80 - math.pi), rel=1e-12)


def test_how_often_v_ref_was_raised():
    log = SimpleNamespace(observables={"v_ref": (None, np.array([2.0, 2.0, 2.0, 2.0, 3.0, 5.0]))})
    assert _reference_speed(log) == {"v_ref": {"start": 2.0, "end": 5.0, "raises": 2}}
