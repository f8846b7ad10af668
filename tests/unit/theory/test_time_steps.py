"""The caveat of gases that move by time steps."""

import pytest

from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene
from idealgas.theory.time_steps import caveats

pytestmark = pytest.mark.interpreted

SCENE = """
box.size = [9, 9]
run = { until = 1, method = "time_driven", dt = 0.1 }
disc = [{ position = [2, 2], velocity = [2, 0], radius = 0.5 }, { position = [6, 6], velocity = [-2, 0], radius = 0.5 }]
"""


def said(*overrides):
    scene = parse_scene(SCENE, overrides=overrides)
    return caveats(scene, make_gas(scene))


def test_displacements_of_a_step_in_diameters():
    """√2 ⟨v⟩ dt = √(π E/M) dt of all discs: √(2π) · 0.1; with masses of 3 and 1, √(8π/4) · 0.1."""
    assert "two discs initially move 0.25 diameters relative" in said()[0]
    assert "two discs initially move 0.25 diameters relative" in said("disc.0.mass=3")[0]
    assert "two discs initially move 0.18 diameters relative" in said("disc.0.radius=0.9")[0]
    assert "collisions are detected late or missed" in said("disc.0.velocity=[0, 0]", "disc.1.velocity=[0, 0]")[0]
    assert said("run.method=event_driven", "run.dt=") == ()
