"""The balances of a granular gas on a vibrating floor, and the motions of a disc on a floor that follows a sine."""

import math

import numpy as np
import pytest
from helpers.logs import log_of
from helpers.support import ROOT, logged

from idealgas import load_scene, temperature


@pytest.fixture(scope="module")
def vibrated():
    return log_of("vibrated-granular", "log.pressure=true")


def rate(log, name, entry, start):
    """Mean rate of a sum in samples after a time, and its standard error, from 16 blocks."""
    time, values = log.observables[name]
    edges = np.linspace(start, log.end_time, 17)
    rates = np.diff(np.interp(edges, time, values[:, entry])) / np.diff(edges)
    return rates.mean(), rates.std(ddof=1) / math.sqrt(len(rates))


def test_a_steady_state_is_recognised(vibrated):
    result = temperature(vibrated)
    assert result.window.state == "steady state"
    assert result.window.start < 100


def test_the_floor_gives_what_collisions_take(vibrated):
    """In the steady state, within 3 standard errors of either."""
    (given, error), (lost, other) = rate(vibrated, "wall_energy", 2, 50), rate(vibrated, "dissipated_energy", 0, 50)
    assert abs(given - lost) < 3 * math.hypot(error, other)
    assert error < 0.03 * given > 0
    _, walls = vibrated.observables["wall_energy"]
    assert not walls[:, [0, 1, 3]].any()  # those at rest


def test_the_floor_carries_the_weight(vibrated):
    """The mean force on it is N m g = 150, within 3 standard errors."""
    force, error = rate(vibrated, "face_normal_impulse", 2, 50)
    assert abs(abs(force) - 150) < 3 * error
    assert error < 3


GAMMA = 0.1 * math.pi**2  # A ω²/g of the shipped scene
E = 0.8


def phases(folder, *overrides):
    """Phases of the impacts of the shipped scene, in periods, between 0 and 1."""
    with logged(load_scene(ROOT / "configs" / "sine-floor.toml", overrides), folder / "run.h5") as log:
        (rows,) = log.chunks()
        return rows.time / 2 % 1


@pytest.mark.interpreted
@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("gamma", [0.6, GAMMA, 1.05])
def test_a_bouncing_disc_locks_to_a_sine(tmp_path, gamma):
    """In the motion of period one, V = A ω sin ωt = (g T/2) (1 - e)/(1 + e); it begins at Γ = π (1 - e)/(1 + e)."""
    actual = phases(tmp_path, f"box.bottom.vibrating.amplitude={gamma / math.pi**2}", "run.until=800")
    expected = 0.5 - math.asin(math.pi * (1 - E) / (1 + E) / gamma) / (2 * math.pi)
    assert np.abs(actual[-100:] - expected).max() < 1e-12
    if gamma == GAMMA:
        assert expected * 2 == pytest.approx(0.88493, abs=5e-6)


@pytest.mark.interpreted
@pytest.mark.usefixtures("uncompiled")
def test_deviations_from_the_motion_of_period_one_follow_the_linear_map(tmp_path):
    """Each is τ times the last, less e² times the one before; τ = 1 + e² + (1 + e)² Γ cos ωt.

    This is the characteristic equation of the derivative of the map from impact to impact.
    """
    actual = phases(tmp_path)
    angle = math.pi - math.asin(math.pi * (1 - E) / (1 + E) / GAMMA)
    trace = 1 + E**2 + (1 + E) ** 2 * GAMMA * math.cos(angle)
    deviation = actual - angle / (2 * math.pi)
    first = int(np.flatnonzero(np.abs(deviation) > 1e-5)[-1]) + 1
    first, second, third = (deviation[first + k : first + k + 20] for k in range(3))
    assert np.abs(third - (trace * second - E**2 * first)).max() < 1e-9
    assert np.abs(first).max() > 1e-6


@pytest.mark.interpreted
@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize(
    ("overrides", "period"),
    [
        (("box.bottom.vibrating.amplitude=0.108",), 1),
        (("box.bottom.vibrating.amplitude=0.109",), 2),
        (("box.bottom.vibrating.amplitude=0.112",), 2),
        (("disc.0.position=[1,1.1]",), 3),
    ],
)
def test_the_period_doubles_where_the_linear_map_says(tmp_path, overrides, period):
    """Stable until Γ² = (π (1 - e)/(1 + e))² + (2 (1 + e²)/(1 + e)²)², that is, 1.071, A = 0.1085."""
    limit = math.hypot(math.pi * (1 - E) / (1 + E), 2 * (1 + E**2) / (1 + E) ** 2)
    assert limit == pytest.approx(1.071, abs=5e-4)
    assert limit / math.pi**2 == pytest.approx(0.1085, abs=5e-5)
    last = phases(tmp_path, *overrides, "run.until=1000")[-12:]
    assert min(k for k in range(1, 7) if np.abs(last[k:] - last[:-k]).max() < 1e-9) == period
