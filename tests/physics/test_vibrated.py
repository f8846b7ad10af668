"""The balances of a granular gas on a vibrating floor."""

import math

import numpy as np
import pytest
from helpers.logs import log_of

from idealgas import temperature


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
