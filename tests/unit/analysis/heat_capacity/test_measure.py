"""The estimators on energies drawn from the ensembles they are made for, and the routes of logs."""

import math

import numpy as np
import pytest
from helpers.logs import gas, log_of
from scipy.signal import lfilter

from idealgas import heat_capacity
from idealgas.analysis.heat_capacity import BATH, CLOSED, PISTON, HeatCapacityAnalysis, Measured
from idealgas.analysis.heat_capacity.fluctuations import (
    LEAST_SAMPLES,
    EnergySeries,
    bath_fluctuations,
    energy_series,
    expected_capacity,
    kinetic_fluctuations,
)
from idealgas.fields import from_dict
from idealgas.statistics.estimates import Estimate

N = 20


@pytest.mark.parametrize("dof", [2, 3], ids=["smooth", "rough"])
def test_heat_bath(dof):
    """Energies of the canonical ensemble follow a Gamma law; four standard errors, and the interval's coverage."""
    random, hits = np.random.default_rng(1), 0
    for _ in range(100):
        energy = 1.5 * random.gamma(dof * N / 2, size=2000)
        result = bath_fluctuations(energy, N, 1.5, 0.0, dof / 2)
        low, high = result.interval()
        hits += low < dof / 2 < high
    assert 85 <= hits <= 100


@pytest.mark.parametrize(
    ("other", "piston"), [(0.5, False), (1.0, False), (1.0, True)], ids=["spin", "height", "piston"]
)
def test_isolated_gas(other, piston):
    """K/E follows Beta(N, b): b = N/2 with spin, N with a height, and N + 3/2 with a piston."""
    random, hits = np.random.default_rng(2), 0
    of_piston = 1.5 if piston else 0.0
    b = other * N + of_piston
    for _ in range(100):
        kinetic = 37.0 * random.beta(N, b, size=3000)
        low, high = kinetic_fluctuations(kinetic, N, 2 * N, of_piston, 1 + other).interval()
        hits += low < 1 + other < high
    assert 85 <= hits <= 100


def test_errors_hold_with_the_least_number_of_samples():
    """Gaussian energies of correlation time 4: rms deviation over error at most 1.1, within three errors of an rms."""
    random, a, runs, deviations = np.random.default_rng(1), math.exp(-1 / 4), 400, []
    length = int(LEAST_SAMPLES * (1 + a) / (1 - a))
    for _ in range(runs):
        energy = 50 + 10 * lfilter([math.sqrt(1 - a * a)], [1, -a], random.normal(size=length + 100))[100:]
        deviations.append(bath_fluctuations(energy, 100, 1.0, 0.0, 1.0).deviation)
    assert np.sqrt(np.mean(np.square(deviations))) < 1.1 + 3 / math.sqrt(2 * runs)


def measured(kind, energy, temperature, errors, routes=None, theory=1.0, excess=None):
    e, t = Estimate(energy, errors[0], 100.0), Estimate(temperature, errors[1], 100.0)
    return Measured("run.h5", kind, N, e, t, "any", routes or {}, theory, excess)


@pytest.mark.parametrize("errors", [(0.0, 0.01), (0.01, 0.0), (0.01, 0.005)], ids=["exact E", "exact T", "neither"])
def test_slope(errors):
    random, deviations, (of_energy, of_t) = np.random.default_rng(3), [], (error or 1e-99 for error in errors)
    for _ in range(200):
        logs = [
            measured(CLOSED, 1.5 * t + random.normal(0, of_energy), t + random.normal(0, of_t), errors, theory=1.5)
            for t in (0.5, 1.0, 1.5, 2.0)
        ]
        (route,) = HeatCapacityAnalysis.combine(logs).routes
        assert route.name == "dE/dT"
        deviations.append(route.value.deviation)
    assert np.std(deviations) == pytest.approx(1.0, abs=0.2)  # 4/√(2·200)
    assert abs(np.mean(deviations)) < 0.3


def test_routes_that_do_not_apply_say_why():
    logs = [measured(BATH, 1.0, 1.0, (0.01, 0.0), {"Var(E)/T²": Estimate(1.0, 0.02, 100.0, 1.0)})]
    result = HeatCapacityAnalysis.combine(logs)
    assert [route.name for route in result.routes] == ["Var(E)/T²"]
    assert set(result.refused) == {"dE/dT", "E/T", "fluctuations of the kinetic energy", "γ"}


def test_gamma_takes_the_best_measured_capacity_at_constant_area():
    c_a = measured(CLOSED, 1.0, 1.0, (0.0, 0.01), {"E/T": Estimate(1.01, 0.01, 100.0, 1.0)})
    routes = {"fluctuations of the kinetic energy": Estimate(2.02, 0.02, 100.0, 2.0)}
    c_p = measured(PISTON, 2.0, 1.0, (0.0, 0.01), routes, 2.0, 1.0)
    gamma = HeatCapacityAnalysis.combine([c_a, c_p]).routes[-1]
    assert gamma.name == "γ"
    assert (gamma.value.value, gamma.value.theory) == pytest.approx((2.0, 2.0))
    alone = HeatCapacityAnalysis.combine([c_p]).routes[-1]
    assert alone.value.value == pytest.approx(2.02 / 1.02)


def test_json_comes_back():
    log = measured(PISTON, 2.0, 1.0, (0.0, 0.01), {"E/T": Estimate(1.0, 0.1, float("inf"), 1.0)}, 2.0, 1.0)
    assert from_dict(Measured, log.as_dict()) == log


def test_a_short_run_with_a_piston_lacks_samples_not_a_piston():
    log = log_of("piston", "run.until=300", "log.snapshot_every=5")
    result = HeatCapacityAnalysis.combine([heat_capacity(log, start=20.0)])
    refused, of_energy = result.refused, result.refused["fluctuations of the kinetic energy"]
    assert "independent samples of the energy are too few (128 needed)" in of_energy
    assert "it requires" not in of_energy
    assert refused["γ"].startswith("the heat capacity of the gas with the piston was not measured")
    assert refused["Var(E)/T²"].startswith("it requires thermal walls")
    rows = [label.get_text() for label in result.figure().axes[0].get_yticklabels()]
    assert rows == ["no dE/dT", "no E/T", "no Var(E)/T²", "no fluctuations", "no γ"]


@pytest.mark.parametrize(
    ("effect", "collisions"), [("rotation={inertia=0.5, roughness=1}", 800), ("gravity.acceleration=[0, -0.1]", 100)]
)
def test_events_tell_the_energy_at_all_times(effect, collisions):
    """The capacity of rough discs is 3N/2; samples at the starts of epochs were too few to give any."""
    few = ("species.0.count=100", f"species.0.radius={math.sqrt(0.1 / math.pi)!r}")
    log = log_of("quickstart", *few, effect, f"run.collisions_per_disc={collisions}")
    series, measured = energy_series(log), heat_capacity(log)
    time, kinetic = log.observables["kinetic_energy"]
    assert energy_series(log, start=float(time[1])).kinetic[0] == pytest.approx(kinetic[1], rel=1e-12)
    assert np.ptp(series.energy) < 1e-9 * series.energy.mean()
    for route in measured.routes.values():
        assert abs(route.deviation) < 4
        assert route.standard_error < 0.3
    assert bool(measured.routes) == (collisions > 100)


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize(
    ("effect", "position", "potential"),
    [
        (f"gravity.acceleration=[0, {-1 / 4.98!r}]", None, 1 - 1 / (2 * math.sinh(0.5)) ** 2),
        ("piston=[{ side='right', mass=50, pressure=4 }]", 10.0, 1.0),
    ],
    ids=["column", "piston"],
)
def test_capacity_of_positions_by_theory(effect, position, potential):
    """For x = mgh/T = 1, x² eˣ/(eˣ - 1)² is 1/(2 sinh ½)². In a dilute gas Z² and d(φZ)/dφ are 1 + 4φ, to order φ²."""
    kinetic = np.full(2, 40.0)
    series = EnergySeries(kinetic, kinetic, position and np.full(2, position), 0.0)
    theory, of_piston = expected_capacity(log_of(gas(40, 0.01, (10, 5), "events = 1"), effect), series)
    assert theory.value == pytest.approx(1 + potential, abs=1e-6)
    assert of_piston == (position and pytest.approx(1.0, abs=1e-6))
