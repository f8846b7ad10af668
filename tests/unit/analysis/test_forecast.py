import math

import pytest

from idealgas.analysis import theory
from idealgas.analysis.forecast import forecast
from idealgas.gas import make_gas
from idealgas.scene import parse_scene

GAS = """
box.size = [10, 20]
run.until = 3
species = [{ name = "a", count = 1000, radius = 0.1, speed = 2, mass = 0.5 }]
"""


def forecast_of(*overrides, text=GAS):
    scene = parse_scene(text, overrides=overrides)
    return forecast(scene, make_gas(scene))


def test_rates_of_one_species():
    expected = forecast_of()
    packing = math.pi * 0.1**2 * 1000 / 200
    rate = theory.collision_rate(0.2, 1000 / 200, 1.0, 0.5, packing) * 999 / 1000  # no disc meets itself
    assert expected.temperature == pytest.approx(1.0, rel=1e-12)
    assert expected.packing_fraction == pytest.approx(packing, rel=1e-12)
    assert expected.collision_rate == pytest.approx(rate, rel=1e-12)
    assert expected.pair_collision_rate == pytest.approx(500 * rate, rel=1e-12)
    assert expected.species[0].collision_rate == pytest.approx(rate, rel=1e-12)


def test_a_species_cut_in_two_alike_changes_nothing():
    half = '{ name = "%s", count = 500, radius = 0.1, speed = 2, mass = 0.5 }'
    cut = forecast_of(text=GAS[: GAS.index("species")] + f"species = [{half % 'a'}, {half % 'b'}]")
    whole = forecast_of()
    for quantity in ("collision_rate", "pair_collision_rate", "wall_hit_rate", "duration", "rows", "bytes"):
        assert getattr(cut, quantity) == pytest.approx(getattr(whole, quantity), rel=1e-12)
    assert [s.number for s in cut.species] == [500, 500]


def test_wall_hits_of_a_dilute_gas_are_effusion():
    """n⟨v⟩/π per length of wall, with the area and the perimeter that centres can reach."""
    expected = forecast_of("species.radius=1e-4")
    area, perimeter = (10 - 2e-4) * (20 - 2e-4), 2 * (30 - 4e-4)
    flux = 1000 / area * math.sqrt(math.pi * 1.0 / (2 * 0.5)) / math.pi
    assert expected.wall_hit_rate == pytest.approx(flux * perimeter, rel=1e-6)


def test_the_first_stop_rule_counts():
    free = forecast_of()
    events_a_time = free.pair_collision_rate + free.wall_hit_rate
    assert free.duration == 3
    assert free.events == pytest.approx(3 * events_a_time)
    assert free.rows == pytest.approx(3 * (events_a_time + free.pair_collision_rate))
    by_events = forecast_of("run.events=500")
    assert by_events.duration == pytest.approx(500 / events_a_time)
    assert by_events.events == pytest.approx(500)
    by_collisions = forecast_of("run.collisions_per_disc=4")
    assert by_collisions.duration == pytest.approx(4 / free.collision_rate)


def test_size_of_the_log():
    rows = forecast_of().rows
    assert forecast_of("log.compression=none").bytes == pytest.approx(49 * rows)
    assert forecast_of("log.events=false").bytes == 0


def test_a_gas_at_rest_has_no_events():
    expected = forecast_of("species.speed=0")
    assert (expected.events, expected.duration) == (0, 3)


def test_a_single_disc_only_meets_walls():
    expected = forecast_of("species.count=1")
    assert expected.pair_collision_rate == 0
    assert expected.wall_hit_rate > 0
