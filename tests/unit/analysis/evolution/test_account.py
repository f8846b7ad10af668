"""The energy account in time, and what follows from a stroke, in numbers by hand."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from idealgas.analysis.evolution.account import HEAT_BATH, STEPS, account
from idealgas.analysis.evolution.means import adiabatic_exponent, mean_temperature, short_stroke
from idealgas.analysis.evolution.theory import EvolutionLaw

pytestmark = pytest.mark.interpreted

WALLS = ("left", "right", "bottom", "top")


def log_of(*pistons):
    scene = SimpleNamespace(piston=pistons, properties=SimpleNamespace(acceleration=(0.0, 0.0)), walls=())
    return SimpleNamespace(walls=[SimpleNamespace(name=name) for name in WALLS], scene=scene, box=(10.0, 8.0))


def test_parts_sources_and_losses_balance():
    """Motion 10 → 9 and height 2 → 3: walls gave 4 and took 1, the bath gave 2, steps 1; 6 were lost by discs."""
    observed = {
        "kinetic_energy": np.array([10.0, 9.0]),
        "potential_energy": np.array([2.0, 3.0]),
        "wall_energy": np.array([[0.0, 0, 0, 0], [4.0, 0, -1.0, 0]]),
        "dissipated_energy": np.array([[0.0, 0, 0, 0, 0], [6.0, 0, 0, 0.5, 0]]),
        "bath_energy": np.array([0.0, 2.0]),
        "step_energy": np.array([0.0, 1.0]),
    }
    parts, sources, losses, balance = account(log_of(), np.array([0.0, 5.0]), observed)
    assert {name: values.tolist() for name, values in parts.items()} == {"motion": [10.0, 9.0], "height": [2.0, 3.0]}
    assert {name: values[1] for name, values in sources.items()} == {"left": 4, "bottom": -1, HEAT_BATH: 2, STEPS: 1}
    assert {name: values[1] for name, values in losses.items()} == {"discs": 6.0, "bottom": 0.5}
    assert balance.tolist() == [0.0, (9 + 3 + 6 - (4 - 1 + 2 + 1) - 12) / 10]  # relative to the largest, the motion
    del observed["bath_energy"], observed["step_energy"]
    assert account(log_of(), np.array([0.0, 5.0]), observed)[3].tolist() == [0.0, (18 - 3 - 12) / 10]


def test_a_piston_with_a_mass_is_a_part():
    """Of mass 2 at 3 → 4 with V = 1 → 2 and A = -0.5: 2 (V²/2 - A X); not what it gave counts, but its losses do."""
    piston = SimpleNamespace(wall="right", mass=2.0, inner=None, name=None, acceleration=lambda *_: -0.5)
    observed = {
        "kinetic_energy": np.array([10.0, 5.0]),
        "wall_energy": np.array([[0.0, 0, 0, 0], [0.0, -7.0, 0, 0]]),
        "dissipated_energy": np.array([[0.0, 0, 0, 0, 0], [0.0, 0, 1.0, 0, 0]]),
        "piston_position": np.array([[3.0], [4.0]]),
        "piston_velocity": np.array([[1.0], [2.0]]),
    }
    parts, sources, losses, balance = account(log_of(piston), np.array([0.0, 1.0]), observed)
    (name,) = set(parts) - {"motion"}
    assert parts[name].tolist() == [4.0, 8.0]
    assert sources[name].tolist() == [0.0, -7.0]
    assert losses[name].tolist() == [0.0, 1.0]
    assert balance.tolist() == [0.0, (5 + 8 + 1 - 14) / 10]


def law(temperature, area=None, steady=False):
    return EvolutionLaw("law", np.array(temperature), area=None if area is None else np.array(area), steady=steady)


def test_an_adiabatic_exponent_between_the_ends():
    """1 + ln(T₂/T₁)/ln(A₁/A₂), here of T 1 → 4 while A 8 → 2: 2; the law has T 1 → 2, 1.5."""
    temperature = np.array([1.0, 1.9, 2.7, 4.0])
    result = adiabatic_exponent(temperature, law([1.0, 1.3, 1.6, 2.0], [8.0, 6.0, 4.0, 2.0]))
    assert (result.value, result.theory) == (pytest.approx(2.0), pytest.approx(1.5))
    assert adiabatic_exponent(temperature, law([1.0, 1.3, 1.6, 2.0], [8.0, 8.0, 8.0, 7.9])) is None
    assert adiabatic_exponent(temperature, law([1.0, 1.3, 1.6, 2.0])) is None
    assert adiabatic_exponent(np.array([1.0, 0.0]), law([1.0, 2.0], [8.0, 2.0])) is None
    assert adiabatic_exponent(temperature, None) is None


def test_strokes_of_few_round_trips():
    """⟨|vx|⟩ = √(2T/πm) = 2/√π, in a box of 10: t · 2/√π/20 round trips."""
    log = log_of(SimpleNamespace(axis=0))
    log.discs = SimpleNamespace(mass=np.array([0.5, 1.5]))
    temperature = np.full(3, 2.0)
    estimate = object()
    for trips, said in ((7.9, 1), (8.1, 0)):
        time = np.array([3.0, 9.0, 3.0 + trips * 10 * math.sqrt(math.pi)])
        assert len(short_stroke(log, estimate, time, temperature)) == said
        assert short_stroke(log, None, time, temperature) == ()


def test_a_constant_temperature_has_no_mean():
    assert mean_temperature(np.full(40, 2.0), law(np.full(40, 2.0), steady=True)) is None
    assert mean_temperature(np.arange(1.0, 41.0), None) is None
    assert mean_temperature(np.arange(1.0, 41.0), law(np.ones(40))) is None
    noise = 2 + np.random.default_rng(1).normal(size=40)
    assert mean_temperature(noise, law(np.full(40, 2.5), steady=True)).theory == 2.5
