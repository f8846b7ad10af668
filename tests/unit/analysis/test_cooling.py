"""Cooling of small gases: against theory, what tells that they are not uniform, and what is refused."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from helpers.against_theory import agrees
from helpers.logs import gas

from idealgas import cooling
from idealgas.analysis.cooling import _moments
from idealgas.analysis.cooling.theory import cooling_theory, law_error
from idealgas.theory import granular
from idealgas.theory.granular import GranularParameters

GAS = gas(300, 0.1, (14, 14), "collisions_per_disc = 70", periodic="xy", seed=1, then="restitution.normal = 0.95")


def test_a_uniform_gas_cools_as_theory_says(make):
    """Within 4 standard errors, and resolved to 3 %."""
    result = cooling(make())
    assert result.caveats == ()
    for estimate, resolution in ((result.loss, 0.03), (result.haff, 0.06), (result.fourth, 2.0)):
        agrees(estimate, resolution)
    assert result.temperature_ratio is None
    assert result.spin is None
    assert result.collisions[-1] == pytest.approx(70, rel=1e-3)
    assert np.diff(result.collisions).std() < 0.5 * np.diff(result.collisions).mean()  # as many between any two times
    assert result.collisions[result.time.searchsorted(result.start)] >= 20
    assert np.abs(np.log(result.temperature / result.law)).max() < 0.2  # e⁻³·⁴ is left
    last = result.last_temperature
    assert (last.value, last.theory) == (result.temperature[-1], result.law[-1])
    assert last.standard_error == pytest.approx(last.value / math.sqrt(300))
    assert "Haff's time: all 3 agree with the theory of a uniform gas (largest deviation" in result.summary()
    assert json.loads(json.dumps(result.as_dict(), allow_nan=False)) == result.as_dict()


@pytest.mark.slow
def test_spins_come_to_a_ratio_of_their_own(make):
    longer = "run.collisions_per_disc=140"
    log = make("rotation={ inertia = 0.5, roughness = 0.5 }", "species.0.spin_temperature=0.2", longer)
    result = cooling(log)
    assert abs(result.temperature_ratio.deviation) < 4
    assert result.temperature_ratio.standard_error < 0.04
    assert result.fourth.theory is None
    assert result.spin[0] == pytest.approx(0.2)
    middle = len(result.time) // 8
    assert result.spin[middle] / result.temperature[middle] > 0.4
    assert abs(math.log(result.spin_law[-1] / result.spin[-1])) < 0.5
    assert len(result.plot().axes) == 4


def test_clusters_are_said(make):
    log = make("restitution.normal=0.5", "species.0.count=1200", "species.0.radius=0.12", "run.collisions_per_disc=60")
    result = cooling(log)
    untested, clusters, flow = result.caveats
    assert "Theory is not available below e" in untested
    assert clusters.startswith("Clusters form: numbers of discs in cells scatter ")
    assert flow.startswith("Discs move together: ")
    assert result.last_scatter.value > 3 * result.first_scatter.value
    assert result.law is None


def test_a_gas_that_cools_more_slowly_than_by_theory_differs_from_it(make):
    """By its temperature at the end, where too few samples tell of its loss and of Haff's time."""
    result = cooling(make())
    few = {name: replace(getattr(result, name), independent_samples=2.0) for name in ("loss", "haff")}
    last = result.last_temperature
    hot = replace(
        result, **few, last_temperature=replace(last, theory=last.value / 10, theory_error=last.theory_error / 10)
    )
    assert "1 of 3 differs from the theory of a uniform gas (largest deviation +" in hot.summary()
    assert hot.summary().endswith("σ, T at the end).")
    assert f"to {last.value:.4g} (Haff's law: {last.value / 10:.4g}) in" in hot.summary()


def test_moments_of_few_discs():
    """Of masses 1 at ±(3, 0) and ±(0, 1): Σ v²/D = 20/6, a₂ = (8/6) ⟨v⁴⟩/2⟨v²⟩² - 1 with 41 and 5; spins of I = 0.5."""
    velocity = np.array([[3.0, 0], [-3, 0], [0, 1], [0, -1]])
    gas = SimpleNamespace(mass=np.ones(4), velocity=velocity)
    kept = SimpleNamespace(conserves_momentum=(True, True), shear=0.0)
    scene = SimpleNamespace(properties=kept, run=SimpleNamespace(method="event_driven"))
    log = SimpleNamespace(discs=gas, scene=scene, inertia=np.full(4, 0.5))
    state = SimpleNamespace(velocity=velocity, angular_velocity=np.array([2.0, 0, 0, -2]))
    temperature, spin, cumulant = _moments(log, state, 6)
    assert (temperature, spin) == (pytest.approx(20 / 6), 1.0)
    assert cumulant == pytest.approx(8 / 6 * 41 / 50 - 1)


def test_haffs_time_of_a_gas_twice_as_fast_is_half_as_long(make):
    slow, fast = (cooling(make(f"species.0.temperature={t}")) for t in (1, 4))
    assert fast.collisions[-1] == pytest.approx(slow.collisions[-1], rel=1e-3)
    assert fast.haff.value == pytest.approx(slow.haff.value / 2, rel=1e-9)
    assert fast.haff.theory == pytest.approx(slow.haff.theory / 2, rel=1e-9)


def test_theory_of_few_discs():
    """Three free discs share energy in 4 of 6 degrees of freedom, and collide 3/2 times as often at one temperature."""
    parameters = GranularParameters(0.9, -1.0, None)
    theory = cooling_theory(parameters, 2.0, (1.0, 0.0), np.array([0.0, 1.0]), number=3, dof=4)
    assert theory.haff.value == pytest.approx(granular.cooling_time(parameters, 3.0), rel=1e-14)
    assert theory.haff.error == pytest.approx(theory.haff.value * math.hypot(0.025, 1 / 4), rel=1e-14)
    assert theory.law[1] == pytest.approx((1 + 1 / theory.haff.value) ** -2, rel=1e-9)
    assert theory.loss.value == pytest.approx(granular.cooling_per_collision(parameters) * 3 / 2, rel=1e-14)
    unknown = cooling_theory(parameters, math.inf, (1.0, 0.0), np.array([0.0, 1.0]), number=3, dof=4)
    assert (unknown.law, unknown.haff, unknown.last_temperature) == (None, None, None)


def test_the_error_of_haffs_law():
    """dT/T = 2 (t/τ)/(1 + t/τ) dτ/τ, with 1 + t/τ = √(T₀/T)."""
    law = np.array([4.0, 1.0, 0.25])
    assert law_error(law, 0.1) == pytest.approx([0.0, 0.2 * 0.5 * 1.0, 0.2 * 0.75 * 0.25])
