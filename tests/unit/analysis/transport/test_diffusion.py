"""Where D has a plateau, and where it has none: between walls, in single file, and in a crystal."""

import json
import math

import numpy as np
import pytest
from helpers.against_theory import agrees
from helpers.logs import gas, log_of

from idealgas.analysis.transport.diffusion import LagLimits
from idealgas.analysis.transport.measure import transport
from idealgas.analysis.transport.result import Transport
from idealgas.analysis.transport.states import transport_states
from idealgas.fields import from_dict


def measured(size, number, collisions, *lags, periodic="", **more):
    """Transport in a gas at some lags."""
    log = log_of(gas(number, 0.5, size, f"collisions_per_disc = {collisions}", periodic=periodic, **more))
    return [transport(log, start=0.0, lag=lag) for lag in lags]


def test_walls_at_a_few_free_paths_leave_no_coefficient():
    """A box of 30 free paths; one of Langevin's displacement √(4Dt) over FREE_SHARE would do, D = T/mΓ by theory."""
    (result,) = measured([20, 20], 51, 200, 20.0)
    (gas,), (rate,) = result.diffusion, result.collision_rates
    assert (gas.plateau, gas.coefficient, gas.velocity_correlation_time) == (None, None, None)
    width = math.sqrt(4 * 10) / rate.rate.value / 0.05
    (sentence,) = [each for each in result.caveats if each.startswith("Walls reflect discs of gas")]
    assert f"or a box about {width:.2g} wide" in sentence
    assert not any("D by displacement" in str(row) for table in result.plain_tables() for row in table.rows)
    *_, coefficients = result.figure().axes
    assert [text.get_text() for text in coefficients.get_legend().get_texts()] == ["D, gas: no plateau"]
    restored = from_dict(Transport, json.loads(json.dumps(result.as_dict(), allow_nan=False)))
    assert transport_states([result, restored]).states[0].coefficients == {}


def test_the_longest_lag_fits_the_box():
    """Lags end where discs have gone a twentieth of the box, whatever was asked; D is Enskog's within its error."""
    result = measured([32, 32], 521, 200, 20.0, 100.0)
    for each in result:
        (gas,), (rate,) = each.diffusion, each.collision_rates
        first, last = gas.plateau
        assert first == pytest.approx(last / 2, rel=0.02)
        assert 10 / rate.rate.value <= last <= gas.lag[gas.displacement <= (0.05 * 31) ** 2][-1]
        agrees(gas.coefficient, 0.05)


def test_the_laws_in_the_figure_pass_through_the_data():
    """Displacement by Fürth (1920) and velocity correlation by Enskog, from the first free time on, not 4Dt from 0."""
    (result,) = measured([30, 30], 60, 1500, 20.0, periodic="xy")
    (gas,) = result.diffusion
    correlation, displacement, *_ = result.figure().axes
    (fuerth,) = (line.get_ydata() for line in displacement.lines if line.get_label().startswith("4D[t - τ"))
    assert fuerth[1:] == pytest.approx(gas.displacement[1:], rel=0.06)
    (enskog,) = (line.get_ydata() for line in correlation.lines if line.get_label().startswith("exp(-t/τ)"))
    early = gas.lag < gas.velocity_correlation_time.value
    assert enskog[early] == pytest.approx(gas.correlation[early], abs=0.03)
    assert len(correlation.collections) == 2


def test_a_channel_of_single_file_has_no_coefficient():
    """1.8 diameters wide, discs cannot pass: ⟨Δx²⟩ grows like √t, Harris, J. Appl. Prob. 2, 323 (1965)."""
    result = measured([40, 1.8], 20, 2000, 20.0, 200.0, periodic="x")
    assert [each.diffusion[0].coefficient for each in result] == [None, None]
    assert all(any("Walls reflect discs of gas" in sentence for sentence in each.caveats) for each in result)


def test_a_crystal_has_no_coefficient():
    size = [14 * 1.1, 16 * 1.1 * math.sqrt(3) / 2]
    (result,) = measured(size, 224, 1000, 20.0, periodic="xy", placement="triangular")
    (gas,) = result.diffusion
    assert gas.coefficient is None
    assert gas.running[-1] < 0.5 * gas.running.max()
    assert any(sentence.startswith("No diffusion coefficient of gas: D falls") for sentence in result.caveats)


def test_what_walls_take():
    """Against the law of diffusion between reflecting walls, half the slope of ⟨Δx²⟩."""
    n, way, time = np.arange(1, 2001, 2), 7.0, 0.01 * 7.0**2
    left = 8 / math.pi**2 * (np.exp(-((n * math.pi / way) ** 2) * time) / n**2).sum()
    result, both = (LagLimits(1.0, 1.0, 1.0, ways).lost(4 * time) for ways in ((way,), (way, way)))
    assert both == pytest.approx(1 - left, rel=1e-3)
    assert result == pytest.approx(both / 2)
