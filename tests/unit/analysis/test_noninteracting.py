"""Discs that do not interact: the theory is that of an ideal gas, and analyses that need collisions refuse."""

import math

import pytest
from helpers.logs import PERIODIC, gas, log_of, raised

from idealgas import billiard, effusion, entropy, heat_capacity, histogram, pressure, temperature
from idealgas.analysis import registry
from idealgas.analysis.registry import shown
from idealgas.errors import NotApplicableError
from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene
from idealgas.theory import hard_discs
from idealgas.theory.forecast import forecast

pytestmark = pytest.mark.usefixtures("uncompiled")

ALONE = "interactions.discs = false"
GAS = gas(60, 0.5, (8, 6), "until = 100", then=ALONE, seed=2)
"""The packing fraction is 0.98, beyond that of any gas of hard discs."""
BATH = "thermostat={ temperature = 1, rate = 0.2 }"


def forecast_of(*overrides):
    scene = parse_scene(GAS, overrides=overrides)
    return forecast(scene, make_gas(scene))


def test_the_forecast_has_no_collisions_and_the_wall_hits_of_an_ideal_gas():
    """60 discs in the area 7 × 5 that centres reach: n⟨v⟩/π hits per length of its perimeter, 24."""
    expected = forecast_of(BATH)
    assert (expected.collision_rate, expected.pair_collision_rate, expected.rough) == (0, 0, "")
    speed = hard_discs.mean_speed(1.0, 1.0, math.inf)
    assert expected.wall_hit_rate == pytest.approx(60 / 35 * speed / math.pi * 24, rel=1e-12)
    assert expected.rows == pytest.approx(100 * (expected.wall_hit_rate + 60 * 0.2), rel=1e-12)
    assert forecast_of().rough == "discs that do not interact do not share their energy"
    column = forecast_of(BATH, "gravity.acceleration=[0, -0.01]", "species.radius=0.001")
    assert (column.collision_rate, column.pair_collision_rate) == (0, 0)


def test_the_pressure_is_that_of_an_ideal_gas_in_the_area_that_centres_reach():
    result = pressure(log_of(GAS, BATH))
    z = {route.name: route.compressibility_factor for route in result.routes}
    assert result.theories == {"ideal gas": 1.0}
    assert z["pairs, virial"].value == z["pairs, virial"].theory == z["walls, virial"].theory == 1
    assert z["left wall"].theory == pytest.approx(8 / 7, rel=1e-14)
    assert z["top wall"].theory == pytest.approx(6 / 5, rel=1e-14)
    for route in z.values():
        assert abs(route.value - route.theory) <= 3.5 * math.hypot(route.standard_error, route.theory_error)
    assert z["all walls"].standard_error < 0.1
    assert result.free_paths == ()
    assert "P A = 1 N T: an ideal gas within the error" in result.summary()


def test_without_heat_energies_along_x_and_y_stay_as_they_are():
    log = log_of(GAS)
    z = {route.name: route.compressibility_factor for route in pressure(log).routes}
    assert z["walls, virial"].theory == 1
    assert (z["left wall"].theory, z["top wall"].theory) == (None, None)
    (entry,) = temperature(log).species
    assert (entry.x.theory, entry.y.theory) == (None, None)
    assert entry.both.value == pytest.approx(entry.both.theory, rel=1e-12)
    why = "discs that do not interact do not share their energy"
    assert histogram(log, quantity="speed").no_law == why
    assert entropy(log).species[0].mean_h.theory is None
    raised(f"requires equilibrium, but {why}", heat_capacity, log, error=NotApplicableError)


def test_paths_between_walls_do_not_depend_on_other_discs():
    path = billiard(log_of(GAS, BATH)).path
    assert (path.theory, path.theory_error) == (pytest.approx(math.pi * 35 / 24, rel=1e-8), 0)


@pytest.mark.parametrize(
    ("name", "overrides", "words"),
    [
        ("transport", (), "requires a gas without non-interacting discs; use"),
        ("sound", PERIODIC, "requires a gas without non-interacting discs; use"),
        ("scattering", PERIODIC, "requires a gas without non-interacting discs; use"),
        ("relaxation", (), "no two discs collide"),
        ("cooling", ("restitution.normal=0.9",), "collisions"),
    ],
)
def test_analyses_that_need_collisions_say_so(name, overrides, words):
    raised(words, registry.analyse, log_of(GAS, *overrides), name, start=0.0)


def test_the_report_does_not_begin_with_them():
    assert "transport" not in shown(parse_scene(GAS, overrides=PERIODIC))


GATE = (
    "wall=[{from=[4, 0], to=[4, 2]}, {from=[4, 4], to=[4, 6]}, {from=[4, 2], to=[4, 4], opens_at=1}]",
    "species.region=[0, 0, 4, 6]",
    "run.until=8",
)


def test_crowding_does_not_hinder_effusion():
    """Of hard discs this dense nothing would be known."""
    assert effusion(log_of(GAS, *GATE)).speed.theory == pytest.approx(
        hard_discs.mean_speed(1.0, 1.0, 120) / math.pi, rel=1e-3
    )
