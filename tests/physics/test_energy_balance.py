"""Energy of shipped scenes and of all effects at once: with what is lost, less what walls gave, it stays the same.

The bound is 1e-12 of the larger of the energy of the gas and the energy turned over, after a million events each of
which rounds.
"""

import json

import numpy as np
import pytest
from helpers.logs import log_of

from idealgas import evolution
from idealgas.analysis.evolution.account import account
from idealgas.theory.conserved import conserved_momentum

pytestmark = pytest.mark.slow

EVENTS = 1_000_000
GAS = f"""
scene.seed = 5
box.size = [40, 30]
log.events = false
run.events = {EVENTS}
gravity.acceleration = [0, -0.05]
rotation = {{roughness = 0.4, wall_roughness = 0.2}}
restitution = {{normal = 0.95, wall = 0.9}}
species = [
    {{name = "a", count = 100, radius = 0.4, temperature = 1, region = [0, 0, 30, 30]}},
    {{name = "b", count = 60, radius = 0.3, mass = 2, temperature = 2, region = [0, 0, 30, 30]}},
]
"""
HOT = "box.bottom = { thermal = 1.5 }\n"
MASSIVE = 'piston = [{side = "right", position = 32, mass = 20, pressure = 0.15}]\n'
DRIVEN = 'piston = [{side = "right", position = 32, velocity = -0.002}]\nrun.until = 6000\n'
SLOPE = "wall = [{from = [3, 4], to = [9, 11]}, {from = [15, 2], to = [15, 9], opens_at = 300}]\n"


@pytest.mark.long
@pytest.mark.parametrize("effects", [HOT + MASSIVE, HOT + DRIVEN + SLOPE], ids=["a piston with a mass", "a driven one"])
def test_a_million_events_of_all_effects(effects):
    log = log_of(GAS + effects)
    assert log.summary["events"] > 0.3 * EVENTS
    result = evolution(log)
    given, lost = (log.observables[name][1][-1] for name in ("wall_energy", "dissipated_energy"))
    energy = log.observables["energy"][1][-1]
    turned_over = max(np.abs(given).max(), lost.sum())
    assert turned_over > 10 * energy  # what is left is not what it began with
    assert lost[0] > 0
    assert lost[1 + 2] == 0  # the thermal wall takes and gives, but loses nothing
    assert (lost[[1, 2, 4]] > 0).all()
    assert abs(log.summary["energy_drift"]) < 1e-12
    assert np.abs(result.balance).max() < 1e-12
    print(f"balance {np.abs(result.balance).max():.1e}, {turned_over / energy:.0f} times the energy turned over")


def test_a_gas_that_cools():
    """Without any source: what is lost is what the gas had, to 1e-12 of it."""
    scene = GAS.replace("gravity.acceleration = [0, -0.05]\n", "").replace(str(EVENTS), "300_000")
    log = log_of(scene)
    first, last = log.observables["energy"][1][[0, -1]]
    lost = log.observables["dissipated_energy"][1][-1].sum()
    assert last < 1e-3 * first
    assert lost == pytest.approx(first - last, rel=1e-12)
    assert abs(log.summary["energy_drift"]) < 1e-12


def test_energy_and_momentum(shipped_scene):
    """Energy of every shipped scene to 1e-12, with what collisions lost, less what thermal walls or a piston gave.

    What inelastic collisions take is counted and only grows. Momentum to 1e-12 along axes on which no wall takes any.
    At every sample of a run of twenty thousand events.
    """
    log = log_of(shipped_scene, "run.events=20000")
    scene, summary = log.scene, log.summary
    assert log.complete
    assert abs(summary["energy_drift"]) < 1e-12
    assert summary["deepest_overlap"] < 1e-12
    assert (summary["energy_change"] < 0) or not scene.restitution or scene.properties.vibrates
    assert json.loads(json.dumps(summary)) == summary
    samples = log.observables["kinetic_energy"][0]
    *_, dissipated, balance = account(log, samples, {name: series for name, (_, series) in log.observables.items()})
    assert np.abs(balance).max() < 1e-12
    assert bool(dissipated) == bool(scene.restitution)
    assert all((np.diff(lost) > 0).all() for lost in dissipated.values())
    momentum = log.observables["momentum"][1]
    size = (log.discs.mass * np.hypot(*log.discs.velocity.T)).sum()
    assert np.abs(momentum - momentum[0])[:, conserved_momentum(log.scene)].max(initial=0.0) <= 1e-12 * size
    assert len(samples) >= 2
