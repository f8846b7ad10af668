"""Speeds, energies and free times that follow from a scene, by hand."""

import math

import numpy as np
import pytest

from idealgas.scene import parse_scene
from idealgas.scene.defaults import mean_kinetic_energy, mean_speed, reference_speed

pytestmark = pytest.mark.interpreted

GAS = """
box.size = [20, 10]
run.events = 300
species = [
    { name = "hot", count = 3, radius = 0.25, mass = 2, temperature = 4 },
    { name = "even", count = 2, radius = 0.5, speed = 3 },
    { name = "given", count = 2, radius = 0.5, velocities = [[3, 4], [0, 1]] },
]
disc = [{ position = [1, 1], velocity = [-6, 8], radius = 0.25, mass = 3 }]
"""


def test_means_over_all_discs():
    """Speeds √(πT/2m) = √π of three, 3 of two, 5 and 1, and 10; energies T, m v²/2 of the others."""
    scene = parse_scene(GAS)
    assert scene.mean_speed == pytest.approx((3 * math.sqrt(math.pi) + 6 + 6 + 10) / 8, rel=1e-15)
    assert scene.mean_kinetic_energy == pytest.approx((12 + 9 + 13 + 150) / 8, rel=1e-15)
    assert (scene.number_of_discs, scene.largest_radius) == (8, 0.5)
    assert scene.covered_area == pytest.approx(math.pi * (4 / 16 + 4 / 4), rel=1e-15)
    assert mean_speed([], np.empty((0, 2))) == mean_kinetic_energy([], np.empty(0), np.empty((0, 2))) == 0.0
    assert reference_speed(scene.run, 4.0) == 20.0


def test_free_times_of_a_dilute_gas():
    """Of a disc 1/(√2 σ n (N - 1)/N χ + wall hits) at the mean speed; a fall through half of the room adds to v²."""
    text = """
        box.size = [20, 10]
        run.events = 300
        species = [{ name = "gas", count = 40, radius = 0.1, speed = 2 }]
    """
    phi = 40 * math.pi * 0.01 / 200
    chi = (1 - 7 * phi / 16) / (1 - phi) ** 2
    per_length = math.sqrt(2) * 0.2 * 39 / 200 * chi + 2 / math.pi * (1 / 19.8 + 1 / 9.8)
    scene = parse_scene(text)
    assert scene.mean_free_time == pytest.approx(1 / per_length / 2, rel=1e-13)
    assert scene.expected_end == pytest.approx(300 / 40 / per_length / 2, rel=1e-13)
    falling = parse_scene(text + "gravity.acceleration = [0.5, -3]")
    assert falling.mean_free_time == pytest.approx(1 / per_length / math.sqrt(4 + 0.5 * 20 + 3 * 10), rel=1e-13)
