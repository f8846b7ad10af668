import math

import pytest
from helpers.logs import PERIODIC, gas, log_of

from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene
from idealgas.theory import hard_discs
from idealgas.theory.forecast import forecast

GAS = gas(1000, 0.1, (10, 20), "until = 3", speed=2, mass=0.5, name="a")
BATH = "thermostat={ temperature = 4, rate = 0.3 }"


def forecast_of(*overrides, text=GAS):
    scene = parse_scene(text, overrides=overrides)
    return forecast(scene, make_gas(scene))


def test_rates_of_one_species():
    expected = forecast_of()
    packing = math.pi * 0.1**2 * 1000 / 200
    rate = hard_discs.collision_rate(0.2, 1000 / 200, 1.0, 0.5, packing) * 999 / 1000  # no disc meets itself
    assert expected.temperature == pytest.approx(1.0, rel=1e-12)
    assert expected.packing_fraction == pytest.approx(packing, rel=1e-12)
    before_a_piston = forecast_of("piston=[{ position = 8, mass = 1, pressure = 10 }]").packing_fraction
    assert before_a_piston == pytest.approx(packing * 10 / 8, rel=1e-12)
    assert expected.collision_rate == pytest.approx(rate, rel=1e-12)
    assert expected.pair_collision_rate == pytest.approx(500 * rate, rel=1e-12)
    assert expected.species[0].collision_rate == pytest.approx(rate, rel=1e-12)


def test_conserved_momentum_takes_degrees_of_freedom():
    channel, box = forecast_of(*PERIODIC[:2]), forecast_of(*PERIODIC)
    frame = box.species[0].temperature  # without the motion of the gas as a whole
    assert box.temperature == pytest.approx(frame * 1000 / 999, rel=1e-12)
    assert channel.temperature == pytest.approx(channel.species[0].temperature * 2000 / 1999, rel=1e-12)


def test_a_gas_in_a_heat_bath_has_its_temperature_and_thermostat_collisions():
    free, hot = forecast_of(), forecast_of(BATH)
    assert (hot.temperature, hot.beyond) == (4, ())
    assert (hot.thermostat_collision_rate, free.thermostat_collision_rate) == (300, 0)
    for quantity in ("collision_rate", "pair_collision_rate", "wall_hit_rate"):
        assert getattr(hot, quantity) == pytest.approx(2 * getattr(free, quantity), rel=1e-12)
    assert hot.events == pytest.approx(3 * (hot.pair_collision_rate + hot.wall_hit_rate + 300))
    assert hot.rows == pytest.approx(hot.events + 3 * hot.pair_collision_rate)
    walls, colder = (forecast_of(BATH, f"box.left={{ thermal = {t} }}") for t in (4, 1))
    assert (walls.temperature, walls.beyond) == (4, ())
    assert colder.beyond == ("thermal walls", "thermostat")


@pytest.mark.parametrize(
    "heated", [("box.top={ thermal = 4 }",), ("box.left={ thermal = 4 }", "box.top={ thermal = 4 }")]
)
def test_walls_of_one_temperature_give_it_to_the_gas(heated):
    """Rates are proportional to √T, and T is 1 without them."""
    free, hot = forecast_of(), forecast_of(*heated)
    assert (hot.temperature, hot.beyond) == (4, ())
    for quantity in ("collision_rate", "pair_collision_rate", "wall_hit_rate"):
        assert getattr(hot, quantity) == pytest.approx(2 * getattr(free, quantity), rel=1e-12)
    column = forecast_of(*heated, "gravity.acceleration=[0, -0.2]", "species.radius=0.005", "species.count=100")
    assert (column.temperature, column.beyond) == (4, ())
    assert column.collision_rate > 0
    assert forecast_of(*heated, "box.bottom={ thermal = 1 }").temperature is None


@pytest.mark.parametrize("heated", [(), ("box.top={ thermal = 4 }",)])
def test_walls_inside_leave_the_temperature(heated):
    """2E/2N = 1, or that of thermal walls; it is approximate, as walls may divide the gas."""
    wall = "wall=[{ from = [1, 1], to = [2, 2] }]"
    result = forecast_of(wall, *heated)
    assert (result.temperature, result.beyond) == (pytest.approx(4 if heated else 1, rel=1e-12), ("wall segments",))
    assert result.collision_rate is None
    assert "may divide the gas" in result.rough
    assert forecast_of(wall, "gravity.acceleration=[0, -0.2]").temperature is None


def test_a_species_cut_in_two_alike_changes_nothing():
    half = '{ name = "%s", count = 500, radius = 0.1, speed = 2, mass = 0.5 }'
    cut, whole = forecast_of(f"species=[{half % 'a'}, {half % 'b'}]"), forecast_of()
    for quantity in ("collision_rate", "pair_collision_rate", "wall_hit_rate", "duration", "rows", "bytes"):
        assert getattr(cut, quantity) == pytest.approx(getattr(whole, quantity), rel=1e-12)
    assert [s.number for s in cut.species] == [500, 500]


def test_gases_of_few_events():
    """At rest there are none; a single disc meets walls only."""
    still, single = forecast_of("species.speed=0"), forecast_of("species.count=1")
    assert (still.events, still.duration) == (0, 3)
    assert single.pair_collision_rate == 0
    assert single.wall_hit_rate > 0


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
    turning = forecast_of("log.compression=none", "rotation.roughness=1")
    assert turning.bytes == pytest.approx((49 + 8) * turning.rows)


@pytest.mark.parametrize("compression", ["gzip", "none"])
def test_size_of_a_log_with_snapshots_is_that_of_the_file(compression):
    more = f"log = {{ snapshot_every = 0.01, compression = '{compression}' }}"
    text = gas(600, 0.1, (20, 20), "until = 20", seed=1, then=more)
    assert forecast_of(text=text).bytes == pytest.approx(log_of(text).path.stat().st_size, rel=0.1)


def test_spins_take_a_third_of_the_energy():
    rough = forecast_of("rotation.roughness=1")
    assert rough.temperature == pytest.approx(2 / 3, rel=1e-12)
    spinning = forecast_of("rotation.roughness=1", "species.spin_temperature=2.5")
    assert spinning.temperature == pytest.approx((2 * 1 + 2.5) / 3, rel=1e-12)
    given = forecast_of("rotation.roughness=1", "species.angular_velocity=2")
    assert given.temperature == pytest.approx((2 * 1 + 0.5 * 0.5 * 0.01 * 4) / 3, rel=1e-12)


def test_only_walls_are_hit():
    tall = forecast_of("species.radius=1e-4")
    periodic = forecast_of("species.radius=1e-4", "box.left=periodic", "box.right=periodic")
    hotter = math.sqrt(periodic.temperature / tall.temperature)
    assert periodic.wall_hit_rate == pytest.approx(tall.wall_hit_rate * 20 / 60 * hotter, rel=1e-4)
    at_rest_as_a_whole = ("species.speed=", "species.temperature=1")
    endless = forecast_of(*PERIODIC, *at_rest_as_a_whole)
    assert endless.wall_hit_rate == 0
    closed = forecast_of(*at_rest_as_a_whole)
    hotter = math.sqrt(endless.temperature / closed.temperature)
    assert endless.collision_rate == pytest.approx(closed.collision_rate * hotter, rel=1e-12)


@pytest.mark.parametrize(
    ("override", "beyond"),
    [
        ("gravity.acceleration=[0, -1]", "gravity"),
        ("restitution.normal=0.9", "restitution"),
        ("rotation.roughness=0.5", "rotation"),
        ("piston=[{ mass = 1, pressure = 10 }]", "piston"),
    ],
)
def test_what_is_beyond_theory_is_not_known(override, beyond):
    expected = forecast_of(override)
    assert expected.beyond == (beyond,)
    unknown = ("temperature", "collision_rate", "pair_collision_rate", "wall_hit_rate", "events", "rows", "bytes")
    assert all(getattr(expected, name) is None for name in unknown)
    assert expected.species[0].collision_rate is None
    assert expected.duration == 3
    assert forecast_of(override, "run.events=9").duration is None


def test_rates_of_a_rough_theory_are_marked():
    lattice = ("species.count=4000", "species.radius=0.1001", "box.size=[10, 19]", "species.placement=lattice")
    for overrides, why in (
        ((), ""),
        (("species.count=10",), "off by up to"),
        (lattice, "above 0.62"),
        (("species.count=1",), "holds fewer than 3"),
    ):
        rough = forecast_of(*overrides).rough
        assert why in rough, overrides
        assert bool(why) == bool(rough), overrides


def test_a_column_under_gravity():
    """Temperature and rates of equal discs by the barometric law in a box so high that its lid does not count.

    The energy of motion and height is 2NT; a pair meets at the rate 2σ ∫n² √(πT/m) per disc, with ∫n² of the law
    N/W mg/2T. The floor is hit as if it carried the weight: n(0) ⟨v⟩/π W.
    """
    tall = ("box.size=[20, 400]", "species.radius=0.005", "species.count=400", "species.region=[0, 0, 20, 40]")
    expected = forecast_of(*tall, "gravity.acceleration=[0, -0.2]")
    m, g, n = 0.5, 0.2, 400
    gas = make_gas(parse_scene(GAS, overrides=(*tall, "gravity.acceleration=[0, -0.2]")))
    t = (gas.kinetic_energy + m * g * float((gas.position[:, 1] - 0.005).sum())) / (2 * n)
    assert expected.temperature == pytest.approx(t, rel=1e-9)
    rate = 2 * 0.01 * (n - 1) / 20 * m * g / (2 * t) * math.sqrt(math.pi * t / m)
    assert expected.collision_rate == pytest.approx(rate, rel=2e-3)
    flux = math.sqrt(math.pi * t / (2 * m)) / math.pi
    assert expected.wall_hit_rate == pytest.approx(flux * n * (m * g / t + 2 / (20 - 0.01)), rel=2e-2)
    assert expected.beyond == ()
    assert "dilute column" in expected.rough
    towering = forecast_of("box.size=[20, 4e5]", *tall[1:], "gravity.acceleration=[0, -0.2]")
    assert towering.collision_rate == pytest.approx(expected.collision_rate, rel=2e-3)
    sideways = forecast_of(
        "box.size=[400, 20]", *tall[1:3], "species.region=[360, 0, 400, 20]", "gravity.acceleration=[0.2, 0]"
    )
    assert sideways.collision_rate == pytest.approx(expected.collision_rate, rel=0.05)


def test_other_columns_are_not_known():
    dilute = ("species.radius=0.005", "species.count=100")
    assert forecast_of(*dilute, "gravity.acceleration=[0, -0.2]").temperature
    for override in (
        "gravity.acceleration=[0.1, -0.2]",
        "box={ size = [10, 20], left = 'periodic', right = 'periodic' }",
    ):
        assert forecast_of(*dilute, "gravity.acceleration=[0, -0.2]", override).beyond == ("gravity",)


def test_trials_are_about_right_where_the_reference_speed_rises():
    text = """
        box.size = [10, 10]
        species = [{ name = "gas", count = 300, radius = 0.05, speed = 1 }]
        run = { method = "monte_carlo", trials = 9000 }
    """
    assert "v_ref rises" in forecast_of(text=text).rough
    assert forecast_of(text=text.replace("trials = 9000", "trials = 9000, v_ref = 5")).rough == ""
    assert forecast_of(text=text.replace("trials = 9000", "events = 9000")).rough == ""
