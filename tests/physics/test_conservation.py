"""What each shipped scene conserves, at every sample of a run of twenty thousand events."""

import json

import numpy as np
import pytest

from idealgas.analysis.core.ensemble import conserved_momentum
from idealgas.analysis.evolution.account import account
from idealgas.log import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import load_scene

pytestmark = pytest.mark.slow


def test_energy_and_momentum(shipped_scene, tmp_path):
    """Energy to 1e-12, with what collisions lost and less what thermal walls or a piston gave.

    What inelastic collisions take is counted and only grows. Momentum to 1e-12 along axes on which no wall takes any.
    """
    scene = load_scene(shipped_scene, ["run.events=20000"])
    summary = simulate(scene, tmp_path / "run.h5")
    assert summary.completed
    assert abs(summary.energy_drift) < 1e-12
    assert summary.deepest_overlap < 1e-12
    assert (summary.energy_change < 0) or not scene.restitution
    with open_log(tmp_path / "run.h5") as log:
        assert log.complete
        assert json.loads(json.dumps(log.summary)) == log.summary
        samples = log.observables["kinetic_energy"][0]
        *_, dissipated, balance = account(log, samples, {name: series for name, (_, series) in log.observables.items()})
        assert np.abs(balance).max() < 1e-12
        assert bool(dissipated) == bool(scene.restitution)
        assert all((np.diff(lost) > 0).all() for lost in dissipated.values())
        momentum = log.observables["momentum"][1]
        size = (log.discs.mass * np.hypot(*log.discs.velocity.T)).sum()
        assert np.abs(momentum - momentum[0])[:, conserved_momentum(log)].max(initial=0.0) < 1e-12 * size
        assert len(samples) >= 2
