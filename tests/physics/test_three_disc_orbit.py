"""The unstable orbit of three discs: the exact motion, and how the digits carried set how long it lasts."""

import math

import mpmath
import numpy as np
import pytest
from helpers.support import ROOT, record
from mpmath import mpf

from idealgas.accuracy.orbit import columns_at, is_on_orbit, orbit_gas, study_orbit, survival, three_disc_orbit
from idealgas.engine.multiprecision import PreciseBruteForce
from idealgas.engine.simulation import Simulation, Stop
from idealgas.initial.build import make_gas
from idealgas.scene import load_scene

pytestmark = pytest.mark.slow

BOX, RADIUS = (10.2, 6.2), math.sqrt(0.5)
GROWTH = 2500.0  # of a deviation, each period


def exact_events(box, radius, periods):
    """(time, smaller disc, whom it meets, x, y of that disc), to 50 digits: from the geometry alone."""
    width, height, r = (mpf(length) for length in (*box, radius))
    d = mpmath.sqrt(2) * r
    drop, flight = height - d - 2 * r, (width - height - d) / 3
    low, high = (height - d) / 2, (height + d) / 2
    right = width - r - d - flight - drop / 2
    left = right - flight
    actual = [(flight / 2 + drop / 2, 0, -1, r, high)]  # after the left dance of the period before
    for k in range(periods):
        t = flight / 2 + k * 2 * (drop + flight)
        for inner, outer, disc in ((right, right + d, 2), (left, left - d, 0)):
            side, at = (-2, width - r) if disc == 2 else (-1, r)
            first, second = sorted(((1, inner, low), (disc, outer, high)))
            for meeting in (t, t + drop):
                actual += [(meeting, first[0], second[0], *first[1:]), (meeting, second[0], first[0], *second[1:])]
            actual += [(t + drop / 2, 1, -3, inner, r), (t + drop / 2, disc, -4, outer, height - r)]
            actual.append((t + drop + flight + drop / 2, disc, side, at, high))
            t += drop + flight
    end = periods * 2 * (drop + flight)
    return sorted(event for event in actual if 0 < event[0] < end)


@pytest.mark.parametrize(("box", "radius"), [(BOX, RADIUS), ((23.7, 18.1), 0.9), ((5.0, 2.3), 0.2)])
def test_the_exact_motion(box, radius):
    """Every event of two periods at its place and time, to 16 digits; back at the start, to 32 less two periods'."""
    orbit = three_disc_orbit(box, radius)
    gas = orbit_gas(orbit, box, radius)
    made = Simulation(gas, PreciseBruteForce("double-double", columns_at(orbit, gas, "double-double")))
    rows = record(made, Stop(time=2 * float(orbit.period)))
    with mpmath.workdps(50):
        expected = exact_events(box, radius, 2)
        assert len(expected) == len(rows.time) == 28
        order = np.lexsort((rows.disc, np.round(rows.time, 9)))
        result = sorted(expected, key=lambda event: (round(float(event[0]), 9), event[1]))
        assert rows.disc[order].tolist() == [event[1] for event in result]
        assert rows.partner[order].tolist() == [event[2] for event in result]
        assert np.abs(rows.time[order] - [float(event[0]) for event in result]).max() < 4e-15 * rows.time[-1]
        place = np.array([[float(event[3]), float(event[4])] for event in result])
        assert np.abs(rows.position[order] - place).max() < 4e-16 * max(box)
        at_end = [
            mpf(float(c.x[i, 0])) + mpf(float(c.x[i, 1])) + mpf(float(c.vx[i, 0])) * (mpf(str(2 * orbit.period)) - t)
            for c in [made.method.columns]
            for i, t in enumerate(mpf(float(high)) + mpf(float(low)) for high, low in c.t)
        ]
        assert max(abs(a - mpf(str(b))) for a, b in zip(at_end, orbit.x, strict=True)) < 2.0**-104 * GROWTH**2 * 1e3


def test_the_shipped_scene_is_on_its_orbit_and_others_are_not():
    configs = ROOT / "configs"
    assert is_on_orbit(make_gas(load_scene(configs / "three-discs.toml")))
    assert not is_on_orbit(make_gas(load_scene(configs / "three-discs.toml", ["box.size=[10.21, 6.2]"])))
    assert not is_on_orbit(make_gas(load_scene(configs / "three-discs.toml", ["disc.0.mass=2"])))
    assert not is_on_orbit(make_gas(load_scene(configs / "corner.toml")))


def test_every_digit_buys_the_same_time():
    """From single to double and on to double-double: medians over 25 placements grow in proportion to the digits.

    A deviation grows by GROWTH each period, so that ten times less of it lasts period/log10(GROWTH) longer. Bound: the
    placements' slopes scatter by 10 %; 25 of them leave 2 %, k = 5 standard errors.
    """
    study = study_orbit(make_gas(load_scene(ROOT / "configs" / "three-discs.toml")))
    assert study.placements >= 12
    single, double, twice = study.survivals
    first = (double.median - single.median) / (double.digits - single.digits)
    second = (twice.median - double.median) / (twice.digits - double.digits)
    expected = study.period / math.log10(GROWTH)
    assert first == pytest.approx(expected, rel=0.1)
    assert second == pytest.approx(expected, rel=0.1)
    assert study.time_per_digit == pytest.approx(expected, rel=0.1)


def test_what_does_not_break_is_counted_and_limits_the_median(monkeypatch):
    gas = make_gas(load_scene(ROOT / "configs" / "three-discs.toml"))
    assert survival(BOX, RADIUS, "float64") < 60
    monkeypatch.setattr("idealgas.accuracy.orbit.MOST_PERIODS", 3)
    assert survival(BOX, RADIUS, "float64") == math.inf
    study = study_orbit(gas, 12)
    double, twice = study.survivals[1:]
    assert twice.unbroken == 12
    assert double.scene is None
    assert twice.median == 3 * study.period
