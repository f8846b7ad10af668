"""The course in time: temperatures, gates and accounts against states and samples, and the laws beside them."""

import json
import math

import numpy as np
import pytest

from idealgas.analysis.evolution.measure import evolution
from idealgas.errors import UserError

GAS = """
scene.seed = 3
box.size = [12, 8]
run.until = 20
species = [{ name = "gas", count = 40, radius = 0.1, temperature = 1.5 }]
"""

PERIODIC = [f"box.{side}='periodic'" for side in ("left", "right", "bottom", "top")]


def test_temperatures_are_those_of_the_states(make):
    log = make("rotation={ inertia = 0.4 }")
    found = evolution(log, 2.0, 10.0)
    assert (found.time[0], found.time[-1]) == (2.0, 10.0)
    state = log.state_at(found.time[100])
    assert found.temperature[100] == pytest.approx((state.velocity**2).sum() / 2 / 40)
    assert found.spin[100] == pytest.approx(0.4 * 0.01 * (state.angular_velocity**2).mean())
    assert found.law.temperature[0] == pytest.approx(1.0)
    assert json.dumps(found.as_dict(), allow_nan=False)


def test_without_events_it_has_the_samples(make):
    log = make("log.events=false", "rotation.inertia=0.4")
    found = evolution(log)
    assert found.time.tolist() == found.samples.tolist()
    assert found.temperature == pytest.approx(found.parts["motion"] / 40)
    assert np.abs(found.balance).max() < 1e-12
    assert found.spin == pytest.approx(found.parts["spin"] * 2 / 40)


def test_a_gate_counts_who_is_beyond(make):
    gate = "wall=[{ from = [6, 0], to = [6, 8], opens_at = 5 }]"
    log = make(gate, "species.region=[0, 0, 6, 8]")
    found = evolution(log)
    share = found.beyond["gas"]
    assert (share[found.time <= 5] == 0).all()
    assert share[-1] == (log.state_at(20.0).position[:, 0] > 6).mean() > 0.2


def test_haff(make):
    """τ of a dilute gas: 4/((1 - e²) 2σn√(πT/m)); what size, number and velocities' a₂ change is some percent."""
    found = evolution(make("restitution.normal=0.8", "species.radius=0.02", *PERIODIC))
    tau = 4 / (0.36 * 2 * 0.04 * 40 / 96 * math.sqrt(math.pi * 1.5))
    t = found.law.temperature
    assert t[0] == pytest.approx(1.5)
    assert 20 / (math.sqrt(t[0] / t[-1]) - 1) == pytest.approx(tau, rel=0.05)
    assert found.balance[-1] < -0.1


def test_adiabat(make):
    """Of points T A stays the same; the discs' size makes it a little more."""
    found = evolution(make("piston={ velocity = -0.2 }", "species.radius=0.001"))
    assert found.law.temperature[-1] == pytest.approx(1.5 * 12 / 8, rel=1e-3)
    assert found.piston[[0, -1]] == pytest.approx([12, 8])
    assert found.given["right"][-1] == pytest.approx(found.parts["motion"][-1] - 60)


def test_a_piston_with_a_mass_keeps_its_balance_and_has_a_place(make):
    found = evolution(make("piston={ side = 'left', position = 4, mass = 5, pressure = 1 }", "species.radius=0.001"))
    assert np.abs(found.balance).max() < 1e-12
    assert set(found.parts) == {"motion", "piston"}
    energy, n = 60 + 8 * (8 - 0.002), 40
    t = energy / (2 * n + 1.5)
    assert found.law.temperature[0] == pytest.approx(t, rel=1e-3)
    assert 12 - found.law.piston == pytest.approx(0.002 + (n + 1) * t / 8, rel=1e-3)


@pytest.mark.parametrize(
    ("overrides", "t"),
    [
        ([], 1.5),
        (["box.left={ thermal = 2 }"], 2.0),
        (PERIODIC, 1.5),
        (["box.left={ thermal = 2 }", "box.right={ thermal = 1 }"], None),
        (["rotation.roughness=0"], None),
    ],
)
def test_equilibrium(make, overrides, t):
    found = evolution(make(*overrides, "run.until=2"))
    assert (found.law is None) == (t is None)
    assert t is None or found.law.temperature[-1] == pytest.approx(t)


def test_times_that_are_not_there(make):
    with pytest.raises(UserError, match="no window"):
        evolution(make(), 5.0, 30.0)
