import csv
import io
import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from idealgas.analysis.pressure.equation_of_state import equation_of_state
from idealgas.analysis.pressure.result import Pressure
from idealgas.analysis.pressure.routes import PAIRS, PressureRoute
from idealgas.analysis.result import Origin
from idealgas.presentation.quantities import as_csv
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.equilibration import Window
from idealgas.theory import hard_discs


def pressure_of(phi, number, z):
    """Result of a run, of which the equation of state uses φ, N and Z of the pairs only."""
    window = Window(np.array([0.0, 1.0]), 0, True)
    route = PressureRoute(PAIRS, z, z)
    return Pressure(window, number, 1.0, 1.0, phi, (route,), {}, {}, (), (), {})


def samples(phis, error, number=1000, runs=4, seed=0):
    """Runs whose Z is theory's at their N with noise of a known size."""
    random = np.random.default_rng(seed)
    for phi in phis:
        z = float(hard_discs.compressibility_factor(phi, number))
        for value in random.normal(z, error * z, runs):
            yield pressure_of(phi, number, Estimate(float(value), error * z, 500.0, z))


def test_virial_coefficients_come_back():
    """Four standard errors; the errors themselves must be small enough to tell B2 to 0.5 %."""
    result = equation_of_state(list(samples(np.linspace(0.02, 0.25, 12), 2e-4, seed=3)))
    assert [state.runs for state in result.states] == [4] * 12
    for coefficient in (result.b2, result.b3):
        assert abs(coefficient.deviation) < 4
    assert result.b2.standard_error < 0.005 * result.b2.value
    assert result.check().agrees is True


def test_spread_of_the_fit_is_its_standard_error():
    phis = np.linspace(0.02, 0.25, 8)
    fits = [equation_of_state(list(samples(phis, 1e-3, seed=k))) for k in range(100)]
    for name in ("b2", "b3"):
        deviations = [getattr(fit, name).deviation for fit in fits]
        assert np.std(deviations) == pytest.approx(1.0, abs=0.3)  # 4/√(2·100)
        assert abs(np.mean(deviations)) < 0.4


def test_a_wrong_pressure_is_found():
    right = [(run.packing_fraction, run.route(PAIRS).compressibility_factor) for run in samples([0.1, 0.2], 1e-4)]
    wrong = [pressure_of(phi, 1000, Estimate(1.01 * z.value, 1e-3, 500.0, z.theory)) for phi, z in right]
    assert equation_of_state(wrong).check().agrees is False


def test_rows_of_states_have_n_and_phi_and_seeds():
    """In CSV each state has a row of Z with the number of the table, for N → ∞."""
    runs = list(samples([0.1, 0.2], 1e-3, number=100, runs=2))
    origins = [Origin(f"{k}.h5", str(k), "", "", "", False, 3 + k % 2, "") for k in range(4)]
    result = equation_of_state([replace(run, origin=origin) for run, origin in zip(runs, origins, strict=True)])
    rows = {row["quantity"]: row for row in csv.DictReader(io.StringIO(as_csv(result.as_dict(), "pressure")))}
    z = [row for name, row in rows.items() if name.endswith(".Z")]
    assert [row["group"] for row in z] == [f"φ = {phi}, N = 100, seeds 3, 4" for phi in (0.1, 0.2)]
    table = result.plain_tables()[0]
    shown = [row[table.heads.index("Z")].value for row in table.rows]
    assert [float(row["value"]) for row in z] == shown == [state.infinite.value for state in result.states]
    of_n = [float(row["value"]) for name, row in rows.items() if name.endswith(".Z_of_this_N")]
    assert of_n == [state.compressibility_factor.value for state in result.states] != shown


def test_every_phase_has_the_theory_that_is_known():
    """Fluid, published simulations, nothing where it freezes, and the crystal, with the error of free-volume theory."""
    published = pressure_of(0.67, 870, Estimate(9.36, 0.01, 10.0, 9.3624))
    unknown, crystal = (pressure_of(phi, 480, Estimate(z, 0.01, 10.0)) for phi, z in ((0.71, 10.2), (0.8, 16.93)))
    result = equation_of_state([*samples([0.1, 0.2], 1e-3), published, unknown, crystal])
    sources = ["virial series, resummed"] * 2 + ["published simulations", None, "free volume, of a crystal"]
    assert [state.source for state in result.states] == sources
    dense = result.states[-1]
    assert dense.infinite.theory == pytest.approx(1 / (1 - math.sqrt(0.8 * math.sqrt(12) / math.pi)))
    assert 0.4 < dense.infinite.theory_error < 0.6
    assert (dense.virial, dense.henderson) == (None, None)
    checked = result.check()
    assert checked.agrees is True
    assert len(checked.compared) == 4
    assert equation_of_state([unknown]).check().agrees is None
    (row,) = (row for row in result.plain_tables()[0].shown if row[0] == "0.71")
    assert row[5:] == ["", "", "", "", ""]
    without_error = equation_of_state([pressure_of(0.1, 100, Estimate(1.2, math.nan, 1.0, 1.2))])
    assert without_error.plain_tables()[0].shown[0][4:6] == ["nan", ""]


@pytest.mark.parametrize(("phis", "numbers"), [((0.05, 0.1), (100, 400)), ((0.05, 0.1, 0.2), (100, 200, 400))])
def test_few_packing_fractions_give_states_however_many_they_are(phis, numbers):
    """Four free parameters or more need as many packing fractions; other numbers of discs do not help."""
    result = equation_of_state([s for n in numbers for s in samples(phis, 1e-3, n, runs=1)])
    assert [(state.packing_fraction, state.number) for state in result.states] == list(product(phis, numbers))
    assert (result.b2, result.b3) == (None, None)
    states, coefficients = result.plain_tables()
    assert len(states.rows) == len(phis) * len(numbers)
    assert states.heads[:2] == ("φ", "N")
    assert coefficients.notes == ("No virial coefficients: a fit requires 4 packing fractions or more, up to 0.25.",)
    assert result.check().agrees is True
    enough = equation_of_state(list(samples((0.05, 0.1, 0.15, 0.2), 1e-3, runs=1)))
    assert enough.b2 is not None


def test_resummed_series_beside_pade_approximants():
    """Both Padé approximants of the ten known terms agree with it within 1e-4 up to φ = 0.55."""
    series = [b * 2.0**k for k, b in enumerate(hard_discs.VIRIAL)]
    for above, below in ((4, 5), (5, 4)):
        matrix = [
            [series[above + k - j] if above + k >= j else 0.0 for j in range(1, below + 1)] for k in range(1, below + 1)
        ]
        q = Polynomial([1.0, *np.linalg.solve(matrix, [-series[above + k] for k in range(1, below + 1)])])
        p = Polynomial((Polynomial(series) * q).coef[: above + 1])
        phi = np.linspace(0.01, 0.55, 55)
        assert hard_discs.compressibility_factor(phi) == pytest.approx(p(phi) / q(phi), rel=1e-4)


@pytest.mark.parametrize(
    ("expansion", "z"), [(10, 1.21068), (5, 1.49838), (3, 2.0771), (2, 3.4243), (1.8, 4.1715), (1.6, 5.4963)]
)
def test_resummed_series_beside_molecular_dynamics(expansion, z):
    """Area over that of close packing: Erpenbeck & Luban, Phys. Rev. A 32, 2920 (1985); theirs are good to 1e-4."""
    assert hard_discs.compressibility_factor(math.pi / math.sqrt(12) / expansion) == pytest.approx(z, rel=2e-4)
