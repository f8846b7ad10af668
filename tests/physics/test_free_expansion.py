"""A gas that expands into the void: what is known before and after its gate opens."""

import math

import pytest
from helpers.logs import log_of

from idealgas import evolution, pressure
from idealgas.analysis.pressure.routes import PAIRS, WALLS
from idealgas.presentation.tables import as_text


@pytest.fixture(scope="module")
def log():
    return log_of("free-expansion")


def test_after_the_gate_is_open_the_theory_of_hard_discs_holds(log):
    """Z N T/A with A of the whole box, N T/A = 5 and Z = 1 + 2φ to a thousandth (B₃ adds 3.128 φ² = 6e-4)."""
    result = pressure(log)
    z = {route.name: route.compressibility_factor for route in result.routes}
    assert z[PAIRS].theory == pytest.approx(1 + 2 * result.packing_fraction, abs=1e-3)
    assert result.check().agrees is True
    assert {row.name for row in result.check().compared} == {WALLS, PAIRS}
    for route in result.routes:
        assert route.pressure.theory == pytest.approx(5 * route.compressibility_factor.theory)
    assert "ideal gas: P = N T/A = 5" in as_text(result.tables())


def test_a_closed_gate_leaves_the_gas_its_half(log):
    """N T/A = 10 with A = 100 on every wall beside the gas, (1 + 2φ)/(1 - 2R/L) = 1.06 times it with the layers; k = 4.

    The empty half has no pressure, and no part in the means of the sides that it shares.
    """
    result = pressure(log, 0.0, 9.0)
    assert result.routes == ()
    assert result.area == pytest.approx(100.0)
    assert result.packing_fraction == pytest.approx(1000 * math.pi * 0.03**2 / 100)
    assert "ideal gas N T/A = 10 " in as_text(result.tables())
    walls = {wall.name: wall.pressure for wall in result.mechanical.walls}
    for name in ("left wall", "bottom wall", "top wall", "gate, left"):
        assert abs(walls[name].value - 10.6) < 4 * walls[name].standard_error, name
    assert walls["right wall"].value == walls["gate, right"].value == 0.0
    assert result.caveats == ("The lengths of sides and A = 100 are those of the chambers with gas, until these open.",)


def test_half_of_the_discs_end_beyond_the_gate(log):
    """50 % with the standard deviation of a binomial distribution, 1/(2√1000); nothing is printed as nan."""
    result = evolution(log)
    each = result.spread["gas"]
    assert each.value == pytest.approx(0.5)
    assert each.standard_error == pytest.approx(1 / (2 * math.sqrt(1000)))
    late = result.beyond["gas"][result.time > 100]
    assert abs(late.mean() - 0.5) < 4 * each.standard_error
    text = as_text(result.tables())
    assert "beyond the wall in equilibrium: 50.0% ± 1.6% of gas (binomial)" in text
    assert "nan" not in text
