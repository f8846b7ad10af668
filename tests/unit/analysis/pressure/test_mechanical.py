"""The pressure of gases without an equation of state: what is said, shown and refused."""

import json

import numpy as np
import pytest
from helpers.logs import PERIODIC, gas, raised

from idealgas.analysis import registry
from idealgas.analysis.caveats import origin_of
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.pressure.mechanical import WallPressure
from idealgas.analysis.pressure.result import _on_walls, _unlike
from idealgas.statistics.estimates import Estimate

UP = "piston=[{ side = 'top', position = 4, mass = 8, pressure = 2 }]"
GAS = gas(30, 0.1, (8, 6), "until = 40", temperature=1.5, seed=3)

EFFECTS = {
    "gravity.acceleration=[0, -0.3]": "gravity",
    UP: "piston",
    "wall=[{ from = [4, 0], to = [4, 3] }]": "wall segments",
    "restitution.normal=0.95": "restitution",
    "box={ size = [8, 6], left = { thermal = 1 }, right = { thermal = 2 } }": "several temperatures",
}


@pytest.mark.parametrize("override", EFFECTS)
def test_every_effect_has_a_pressure_of_its_walls(override, make):
    result = pressure(make(override))
    assert result.routes == ()
    assert result.theories == {}
    assert result.no_theory == f"no equation of state holds under {EFFECTS[override]}"
    assert result.check().agrees is None
    walls = {wall.name: wall.pressure for wall in result.mechanical.walls}
    assert {"left wall", "right wall", "bottom wall", "top wall"} <= set(walls)
    for name, value in walls.items():
        assert 0 < value.value < 8, name
        assert 0 < value.standard_error < value.value, name
    known = json.loads(json.dumps(result.as_dict(), allow_nan=False))
    assert [wall["wall"] for wall in known["walls"]] == list(walls)
    assert known["forces"][-1]["wall"] == "all walls"
    tables = result.plain_tables()
    assert f"Theory is not available: {result.no_theory}." in tables[0].notes
    assert len(tables[0].rows) == len(walls)
    assert [label.get_text() for label in result.figure().axes[0].get_yticklabels()] == list(walls)[::-1]


def test_a_plain_box_has_routes_and_no_more(make):
    result = pressure(make())
    assert result.mechanical is None
    assert {"walls", "forces"}.isdisjoint(result.as_dict())


def theories(result):
    return {wall.name: wall.pressure.theory for wall in result.mechanical.walls}


def test_the_outer_pressure_is_the_theory_of_a_piston_alone(make):
    sides = dict.fromkeys(("left wall", "right wall", "bottom wall"))
    assert theories(pressure(make(UP))) == sides | {"top wall": 2.0}
    heavy = pressure(make(UP, "gravity.acceleration=[0, -0.5]"))
    assert theories(heavy)["top wall"] == pytest.approx(2 + 8 * 0.5 / 8)
    assert heavy.mechanical.forces[-1].y.theory == pytest.approx(-15.0)  # the weight of 30 discs
    assert (
        theories(pressure(make("piston=[{ side = 'top', mass = 8, pressure = 0.2 }]")))["top wall"] is None
    )  # at its stop


def test_a_state_that_changes_all_the_time_is_averaged_and_said_so(make):
    result = pressure(make("piston=[{ velocity = -0.05 }]"))
    assert (result.window.start, result.window.detected) == (0.0, False)
    assert result.mechanical.unsteady == "the gas is driven (piston)"
    assert any("`evolution` shows P(t)" in note for note in result.plain_tables()[0].notes)
    assert result.area == pytest.approx(6 * 7)
    assert result.packing_fraction == pytest.approx(30 * np.pi * 0.01 / 42)
    assert result.mechanical.forces[-1].x.theory is None
    assert pressure(make("piston=[{ velocity = -0.05 }]"), start=20.0).area == pytest.approx(6 * 6.5)


def test_a_piston_is_held_in_a_gas_that_cools_too(make):
    walls = {wall.name: wall.pressure for wall in pressure(make(UP, "restitution.normal=0.99")).mechanical.walls}
    assert walls["top wall"].theory == 2.0
    assert walls["top wall"].standard_error < 0.2 * walls["left wall"].standard_error


def test_a_heat_bath_carries_no_weight_on_average(make):
    """Its impulses are no bounded store: hits of bottom and top are independent, as it changes velocities in between.

    The variance of the force in a time t is then Σ(2mv)²/t², 8 √m T^1.5/√(2π) times their barometric densities, over t.
    """
    result = pressure(make("gravity.acceleration=[0, -0.3]", "thermostat={ temperature = 1.5, rate = 2 }"))
    alone = pressure(make("gravity.acceleration=[0, -0.3]")).mechanical.forces[-1].y
    force, x = result.mechanical.forces[-1].y, 0.3 * 5.8 / 1.5
    assert force.theory == alone.theory == pytest.approx(-9.0)
    hits = 30 / 5.8 * x / np.tanh(x / 2) * 8 * 1.5**1.5 / np.sqrt(2 * np.pi)
    assert force.standard_error == pytest.approx(np.sqrt(hits / (40 - result.window.start)), rel=0.2)
    assert alone.standard_error < force.standard_error / 3
    assert abs(force.deviation) < 4


@pytest.mark.usefixtures("uncompiled")
def test_a_disc_that_meets_nothing_presses_on_nothing(make):
    log = make("species.count=1", "run.until=4", "log={ events=false, pressure=true, snapshot_every=0.1 }", *PERIODIC)
    result = pressure(log).mechanical
    assert result.walls == ()
    assert result.forces[-1].x.value == 0.0


def test_smooth_walls_have_no_stress_and_rough_ones_do(make):
    gravity = "gravity.acceleration=[0, -0.3]"
    assert all(wall.stress is None for wall in pressure(make(gravity)).mechanical.walls)
    rough = pressure(make(gravity, "rotation={ wall_roughness = 0.5, roughness = 1 }"))
    assert all(wall.stress is not None for wall in rough.mechanical.walls if wall.pressure.value > 0)
    assert "Stress along walls (energy/length²)" in [table.title for table in rough.plain_tables()]


def test_a_wall_that_is_never_hit_has_no_error_bar(make):
    result = pressure(make("gravity.acceleration=[0, -20]", "species.region=[0, 0, 8, 2]", "run.until=4"), start=1.0)
    top = next(wall.pressure for wall in result.mechanical.walls if wall.name == "top wall")
    assert (top.value, top.as_dict()["standard_error"]) == (0.0, None)
    (row,) = [row for row in result.plain_tables()[0].shown if row[0] == "top wall"]
    assert row[1:3] == ["0", ""]


def test_no_equation_of_state_of_such_gases(make):
    log = make("gravity.acceleration=[0, -0.3]")
    result, analysis = registry.analyse(log, "pressure"), registry.find("pressure")
    assert analysis.combined([result]) is result
    point = analysis.restored(result.as_dict(), origin_of(log.scene, "sweep, point 3"))
    raised(f"{log.path}: no equation of state holds under gravity", analysis.combine, [result, result])
    raised("sweep, point 3: no equation of state holds under gravity", analysis.combine, [point, point])
    assert repr(point.mechanical) == repr(result.mechanical)


def walls_at(*pressures):
    """Walls inside the box by name, with pressures and standard errors."""
    return [WallPressure(name, Estimate(p, error, 10.0), None) for name, p, error in pressures]


@pytest.mark.parametrize(
    ("walls", "sentence"),
    [
        ([("left wall", 2.0, 0.1), ("wall 4, up", 2.1, 0.1)], "2.00(10) on the left wall"),
        (
            [("wall 4, up", 0.0, np.nan), ("wall 5, down", 2.0, 0.1), ("wall 6, left", 2.1, 0.1)],
            "2.00(10) on the face of wall 5 that looks down, and within 5 standard errors of this on 1 other face",
        ),
        (
            [("drum, inside", 2.0, 0.1), ("lid, a, left", 4.0, 0.1)],
            "2.00(10) on the inside of drum, 4.00(10) on the face of lid, a that looks left",
        ),
        (
            [(f"wall {k}, up", float(k), 0.1) for k in (7, 4, 6, 9, 5)],
            "4.00(10) on the face of wall 4 that looks up to 9.00(10) on the face of wall 9 that looks up",
        ),
    ],
)
def test_the_headline_names_few_of_many_walls(walls, sentence):
    """Each face that clearly differs; a face that was never hit stands for no other."""
    walls = walls_at(*walls)
    assert _on_walls(walls, _unlike(walls)) == sentence
