"""Derivatives of the final state against differences of runs with 32 digits."""

import numpy as np
from helpers.logs import PERIODIC, log_of, raised

import idealgas
from idealgas import open_log, simulate
from idealgas.scene import parse_scene

GAS = """
box.size = [6, 6]
run = { method = "brute_force", precision = "double-double", until = 6 }
species = [{ name = "gas", count = 6, radius = 0.5, temperature = 1 }]
"""


def final(scene, path):
    simulate(scene, path, force=True)
    with open_log(path) as log:
        state = log.state_at(6.0)
        return np.hstack([state.position, state.velocity]), log.state_at(0.0), idealgas.sensitivity(log), len(log)


def test_derivatives_of_a_run(tmp_path):
    """Between walls; the step is as small as the digits of a scene allow, and so are the next derivatives' parts."""
    step = 1e-7
    scene = parse_scene(GAS)
    _, start, result, rows = final(scene, tmp_path / "run.h5")
    assert rows > 30
    for disc, component in ((0, 0), (3, 1), (2, 2), (5, 3)):
        ends = []
        for sign in (1, -1):
            position, velocity = start.position.copy(), start.velocity.copy()
            (position if component < 2 else velocity)[disc, component % 2] += sign * step
            discs = {"position": position, "velocity": velocity, "radius": 0.5, "mass": 1.0}
            run = {"method": "brute_force", "precision": "double-double", "until": 6.0}
            moved = idealgas.Scene(box={"size": [6.0, 6.0]}, discs=discs, run=run)
            ends.append(final(moved, tmp_path / "moved.h5")[0])
        expected = (ends[0] - ends[1]) / (2 * step)
        derivative = result[:, :, disc, component]
        assert np.abs(derivative - expected).max() < 1e-3 * np.abs(derivative).max()


def test_phase_space_keeps_its_volume():
    """The determinant of the map is 1 in size (Liouville): exact motion of equal masses, 24 dimensions."""
    log = log_of(GAS, *PERIODIC, "run={until=6}")
    result = idealgas.sensitivity(log).reshape(24, 24)
    assert np.abs(np.linalg.slogdet(result)[1]) < 1e-6
    each = idealgas.sensitivity(log, discs=[2])
    assert np.array_equal(each[:, :, 0], idealgas.sensitivity(log)[:, :, 2])
    raised("discs: no disc 6", idealgas.sensitivity, log, discs=[6])
