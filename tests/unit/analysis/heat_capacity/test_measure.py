"""The estimators on energies drawn from the ensembles they are made for."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.heat_capacity import BATH, CLOSED, PISTON, HeatCapacityAnalysis, Measured
from idealgas.analysis.heat_capacity.fluctuations import LEAST_SAMPLES, bath_fluctuations, kinetic_fluctuations

N = 20


@pytest.mark.parametrize("dof", [2, 3], ids=["smooth", "rough"])
def test_heat_bath(dof):
    """Energies of the canonical ensemble follow a Gamma law; four standard errors, and the interval's coverage."""
    random, hits = np.random.default_rng(1), 0
    for _ in range(100):
        energy = 1.5 * random.gamma(dof * N / 2, size=2000)
        found = bath_fluctuations(energy, N, 1.5, 0.0, dof / 2)
        low, high = found.interval()
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
    random, deviations = np.random.default_rng(3), []
    for _ in range(200):
        logs = [
            measured(
                CLOSED,
                1.5 * t + random.normal(0, errors[0] or 1e-99),
                t + random.normal(0, errors[1] or 1e-99),
                errors,
                theory=1.5,
            )
            for t in (0.5, 1.0, 1.5, 2.0)
        ]
        (route,) = HeatCapacityAnalysis.combine(logs).routes
        assert route.name == "dE/dT"
        deviations.append(route.value.deviation)
    assert np.std(deviations) == pytest.approx(1.0, abs=0.2)  # 4/√(2·200)
    assert abs(np.mean(deviations)) < 0.3


def test_routes_that_do_not_apply_say_why():
    logs = [measured(BATH, 1.0, 1.0, (0.01, 0.0), {"Var(E)/T²": Estimate(1.0, 0.02, 100.0, 1.0)})]
    found = HeatCapacityAnalysis.combine(logs)
    assert [route.name for route in found.routes] == ["Var(E)/T²"]
    assert set(found.refused) == {"dE/dT", "E/T", "fluctuations of the kinetic energy", "γ"}


def test_gamma_takes_the_best_measured_capacity_at_constant_area():
    c_a = measured(CLOSED, 1.0, 1.0, (0.0, 0.01), {"E/T": Estimate(1.01, 0.01, 100.0, 1.0)})
    c_p = measured(
        PISTON,
        2.0,
        1.0,
        (0.0, 0.01),
        {"fluctuations of the kinetic energy": Estimate(2.02, 0.02, 100.0, 2.0)},
        2.0,
        1.0,
    )
    gamma = HeatCapacityAnalysis.combine([c_a, c_p]).routes[-1]
    assert gamma.name == "γ"
    assert (gamma.value.value, gamma.value.theory) == pytest.approx((2.0, 2.0))
    alone = HeatCapacityAnalysis.combine([c_p]).routes[-1]
    assert alone.value.value == pytest.approx(2.02 / 1.02)


def test_json_comes_back():
    log = measured(PISTON, 2.0, 1.0, (0.0, 0.01), {"E/T": Estimate(1.0, 0.1, float("inf"), 1.0)}, 2.0, 1.0)
    assert HeatCapacityAnalysis.restore(log.as_dict(), "point") == log
