"""Collision rates of discs that rarely meet."""

import numpy as np
import pytest

from idealgas import open_log, parse_scene, pressure, simulate

SCENE = """
scene.seed = 1
box.size = [10, 10]
species = [
    { name = "grain", count = 2, radius = 0.5, mass = 20, temperature = 1 },
    { name = "gas", count = 50, radius = 0.1, temperature = 1 },
]
run.until = 200
"""


def test_few_collisions_are_few_samples(tmp_path):
    """An error from n events is known no better than from n samples."""
    simulate(parse_scene(SCENE), tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        found = pressure(log)
        duration = found.window.duration
        inside = np.concatenate([b.time > found.window.start for b in log.chunks()])
        disc, partner = (
            np.concatenate([getattr(b, name) for b in log.chunks()])[inside] for name in ("disc", "partner")
        )
        (rate,) = [r.rate for r in found.collision_rates if r.species == r.other == "grain"]
    events = ((disc < 2) & (partner >= 0) & (partner < 2)).sum() / 2
    assert 1 < events < 20
    assert rate.independent_samples <= events
    assert rate.value == pytest.approx(events / duration)
