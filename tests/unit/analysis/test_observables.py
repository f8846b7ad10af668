"""The analyses of a log from end to end: windows, checks, and what is not the same under an effect."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.logs import gas, raised

from idealgas import heat_capacity, histogram
from idealgas.analysis.heat_capacity import CLOSED, HeatCapacityAnalysis
from idealgas.analysis.histogram import QUANTITIES
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.transport.measure import transport
from idealgas.effects.properties import ActiveEffect, Properties
from idealgas.scene import Scene
from idealgas.tallies.equilibration import measure
from idealgas.tallies.flights import Moments

GAS = gas(100, 0.25, (20.0, 15.0), "collisions_per_disc = 150", speed=1.0, seed=5)


def test_default_window_leaves_the_relaxation_out(make):
    """From equal speeds it takes a few collisions per disc, which the fluctuations of this many discs do not hide."""
    log = make("species.0.count=1000", "box.size=[60, 50]")
    window = measure(log, [Moments()])
    assert 0 < window.start < log.end_time / 2
    assert (window.detected, window.end) == (True, log.end_time)


def test_given_window_is_kept(log):
    window = measure(log, [Moments()], 3.0, 17.5)
    assert (window.start, window.end, window.detected) == (3.0, 17.5, False)


def test_windows_without_events_are_refused(log):
    for ends in ((5.0, 5.0), (6.0, 5.0), (-1.0, 5.0), (1e9, None), (None, 1e9), (math.nan, None)):
        raised("empty time window t = .*: the log covers t = 0 to", measure, log, [Moments()], *ends)
    (times,) = next(log.chunks(("time",)))
    gap = np.diff(times).argmax()
    raised("no event between", measure, log, [Moments()], times[gap] + 1e-9, times[gap + 1] - 1e-9)


def test_effects_are_not_ignored(log, monkeypatch):
    monkeypatch.setattr(Scene, "active_effects", (ActiveEffect("magnets", (), Properties(uniform=False)),))
    raised("requires a gas without magnets", transport, log)
    result = pressure(log)
    assert (result.routes, result.no_theory) == ((), "no equation of state holds under magnets")
    assert histogram(log, "free-time").no_law == "the gas is not uniform (magnets)"


def test_check_fails_when_theory_is_off(log):
    result = pressure(log)
    assert result.check().agrees is True

    def moved(route):
        z = route.compressibility_factor
        return replace(route, compressibility_factor=replace(z, theory=z.value + 4.5 * z.standard_error))

    assert replace(result, routes=tuple(moved(route) for route in result.routes)).check().agrees is False
    unknown = tuple(
        replace(r, compressibility_factor=replace(r.compressibility_factor, theory=None)) for r in result.routes
    )
    assert str(replace(result, routes=unknown, no_theory="why").check()) == "Theory is not available: why."
    pairs = replace(result.routes[-1].compressibility_factor, standard_error=math.nan)
    checked = replace(result, routes=(replace(result.routes[-1], compressibility_factor=pairs),)).check()
    assert checked.agrees is None
    assert str(checked).startswith("Too few samples to tell")


def test_histograms_are_densities(log):
    for quantity in QUANTITIES:
        (result,) = histogram(log, quantity).distributions
        share = result.density * np.diff(result.edges)
        assert 0.99 < share.sum() <= 1 + 1e-12, quantity
        middle = (result.edges[1:] + result.edges[:-1]) / 2
        assert share @ middle == pytest.approx(result.mean.value, rel=0.02, abs=0.01), quantity
        assert all(0 <= test.p_value <= 1 for test in result.tests), quantity
        assert result.samples > 100, quantity


def test_heat_capacity_of_one_log(log):
    """The exact energy over the temperature by the pressure."""
    measured = heat_capacity(log)
    (route,) = HeatCapacityAnalysis.combine([measured]).routes
    assert (route.name, route.kind) == ("E/T", CLOSED)
    assert route.value.value == pytest.approx(0.5 / measured.temperature.value, rel=1e-10)


def test_heat_capacity_of_two_logs_has_their_slope(log, make):
    cold, hot = logs = [heat_capacity(log), heat_capacity(make("species.0.speed=2.0", "scene.seed=6"))]
    slope = (hot.energy.value - cold.energy.value) / (hot.temperature.value - cold.temperature.value)
    actual = {route.name: route.value for route in HeatCapacityAnalysis.combine(logs).routes}
    assert actual["dE/dT"].value == pytest.approx(slope, rel=1e-10)
    error = slope * np.hypot(cold.temperature.standard_error, hot.temperature.standard_error) / 1.5 * slope
    assert actual["dE/dT"].standard_error == pytest.approx(error, rel=1e-10)
