"""Chambers of a divided box, against areas and lengths by hand."""

import pytest
from helpers.logs import gas

from idealgas.columns import SIDES
from idealgas.tallies.chambers import Chambers

pytestmark = pytest.mark.usefixtures("uncompiled")

GAS = gas(30, 0.1, (8, 6), "until = 1", seed=3, region=[0, 0, 3, 6])
LEFT, BOTTOM = SIDES.index("left"), SIDES.index("bottom")
ROW = "wall=[{ from = [3, 0], to = [3, 2] }, { from = [3, 6], to = [3, 2], opens_at = 5, closes_at = 9 }]"


def found(log, until=1.0):
    chambers = Chambers(log, until)
    return chambers.area, chambers.length(LEFT), chambers.length(BOTTOM), chambers.divided_gas(BOTTOM, 3.0)


def test_a_row_of_walls_divides_until_one_opens(make):
    log = make(ROW)
    assert found(log) == (18.0, 6.0, 3.0, False)
    assert found(log, 6.0) == (48.0, 6.0, 8.0, True)


@pytest.mark.parametrize(
    "override",
    [
        "wall=[{ from = [3, 0], to = [3, 5] }]",
        "wall=[{ from = [3, 0], to = [3, 2] }, { from = [3, 3], to = [3, 6] }]",
        "box={ size = [8, 6], left = 'periodic', right = 'periodic' }",
    ],
)
def test_a_gap_or_a_periodic_side_joins_chambers(override, make):
    walls = [ROW] if "periodic" in override else []
    assert found(make(override, *walls)) == (48.0, 6.0, 8.0, True)


def test_gas_on_both_sides_is_a_mean(make):
    both = ", ".join(
        f"{{ name = '{name}', count = 9, radius = 0.1, temperature = 1, region = {region} }}"
        for name, region in (("one", "[0, 0, 3, 6]"), ("other", "[3, 0, 8, 6]"))
    )
    assert found(make(ROW, f"species=[{both}]")) == (48.0, 6.0, 8.0, True)
