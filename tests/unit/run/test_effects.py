"""From a scene's tables to the arrays of the engines: what is there, and that nothing else is."""

import math

import numpy as np
import pytest

from idealgas.effects import EFFECTS
from idealgas.initial.build import make_gas
from idealgas.physics.exact_sum import values
from idealgas.physics.wall import SEGMENT
from idealgas.run.effects import make_effects
from idealgas.scene import load_scene, parse_scene

PLAIN = """
box.size = [20, 10]
run.until = 4
species = [
    { name = "a", count = 30, radius = 0.1, temperature = 2 },
    { name = "b", count = 20, radius = 0.2, mass = 3, speed = 1, region = [0, 0, 5, 10] },
]
disc = [{ position = [7, 5], velocity = [1, 0], radius = 0.5, mass = 2 }]
"""


def effects_of(*overrides, text=PLAIN):
    scene = parse_scene(text, overrides=overrides)
    return scene, make_effects(scene, make_gas(scene))


def test_no_table_no_effect_gravity_and_periodic_sides():
    scene, effects = effects_of()
    assert scene.effects == ()
    assert effects == (None,) * len(effects)
    assert effects_of("gravity.acceleration=[0, -0.5]")[1].gravity == (0.0, -0.5)
    periodic = effects_of("box.bottom=periodic", "box.top=periodic")[1].periodic
    assert periodic[:4] == (False, True, 20.0, 10.0)
    assert periodic.shear is None
    assert (periodic.image.shape, periodic.image.dtype, periodic.image.any()) == ((51, 2), np.int32, False)


def assert_as_called_for(scene):
    effects = make_effects(scene, make_gas(scene))
    called = tuple(effect.name for effect in EFFECTS if getattr(effects, effect.field) is not None)
    assert called == scene.effects


def test_a_shipped_scene_has_the_effects_it_calls_for_and_no_others(shipped_scene):
    assert_as_called_for(load_scene(shipped_scene))


def test_a_valid_case_has_the_effects_it_calls_for_and_no_others(valid_case):
    assert_as_called_for(load_scene(valid_case))


WALLS = """wall = [
    { from = [10, 1], to = [13, 5] },
    { from = [10, 8], to = [12, 8], opens_at = 2 },
    { from = [14, 8], to = [16, 8], closes_at = 3, temperature = 4 },
    { from = [14, 2], to = [16, 2], opens_at = 2, closes_at = 3 },
]"""


def test_wall_segments_and_gates():
    effects = effects_of(text=WALLS + PLAIN)[1]
    segments = effects.segments
    assert (segments.x[0], segments.y[0], segments.tx[0], segments.ty[0], segments.length[0]) == (10, 1, 0.6, 0.8, 5)
    changes = [(time, wall, active) for time, _, wall, active in effects.schedule]
    assert changes == [(2, 1, 0), (2, 3, 0), (3, 2, 1), (3, 3, 1)]
    assert segments.active.tolist() == [True, True, False, True]
    assert segments.dtype == SEGMENT


def test_spins():
    """By temperature: the energy is exact, whatever the draw. Inertia is κ m R²."""
    tables = ("species.a.spin_temperature=3", "species.b.angular_velocity=-2", "disc.0.angular_velocity=1")
    rotation = effects_of("rotation.inertia=0.25", "rotation.wall_roughness=0.5", *tables)[1].rotation
    assert rotation.inertia[[0, 1, 31]] == pytest.approx([0.25 * 2 * 0.25, 0.25 * 0.01, 0.25 * 3 * 0.04], rel=1e-15)
    assert rotation.omega[0] == 1
    assert (rotation.omega[31:] == -2).all()
    assert (rotation.inertia * rotation.omega**2)[1:31].sum() == pytest.approx(30 * 3, rel=1e-14)
    assert (rotation.roughness, rotation.wall_roughness) == (1.0, 0.5)
    plain, turning = (
        make_gas(effects_of(*o)[0]) for o in ((), ("rotation.inertia=0.5", "species.a.spin_temperature=3"))
    )
    assert (plain.velocity == turning.velocity).all()
    assert (plain.position == turning.position).all()


def test_restitution():
    scene, effects = effects_of("restitution.normal=0.9")
    assert effects.restitution[:2] == (0.9, 1.0)
    assert (effects.restitution.last == -math.inf).all()
    speed = (30 * math.sqrt(math.pi * 2 / 2) + 20 * 1 + 1) / 51
    diameter = (30 * 0.2 + 20 * 0.4 + 1) / 51
    assert effects.restitution.contact_duration == pytest.approx(1e-6 * diameter / speed, rel=1e-14)
    assert scene.restitution.contact_duration == effects.restitution.contact_duration
    assert effects_of("restitution.normal=0.9", "restitution.contact_duration=1e-4")[1].restitution[2] == 1e-4


def test_thermal_walls():
    effects = effects_of("box.left={ thermal = 1.5 }", "scene.seed=7", text=WALLS + PLAIN)[1]
    assert effects.thermal.temperature.tolist() == [1.5, -1, -1, -1, -1, -1, 4, -1]
    assert effects.thermal.seed == np.uint64(7)
    assert effects.thermal.seed.dtype == np.uint64
    assert effects.thermal.emissions.dtype == np.uint64
    assert values(effects.wall_energy).tolist() == [0.0] * 8


def test_a_thermostat():
    """First collisions follow from the seed: the mean of 51 within 4 of its standard errors, 1/(rate √51)."""
    effects = effects_of("thermostat={ temperature = 1.5, rate = 0.25 }", "scene.seed=7")[1]
    assert effects.thermostat[:3] == (1.5, 0.25, np.uint64(7))
    first = effects.thermostat.time
    assert (first > 0).all()
    assert abs(first.mean() - 4) < 4 * 4 / math.sqrt(51)
    assert (effects_of("thermostat={ temperature = 9, rate = 0.25 }", "scene.seed=7")[1].thermostat.time == first).all()
    assert (effects.thermostat.number.dtype, effects.thermostat.number.any()) == (np.uint64, False)
    assert values(effects.bath_energy).tolist() == [0.0]
    assert effects.wall_energy is None


def test_an_inner_piston_is_the_last_wall_with_two_faces():
    wall = "wall=[{ from = [1, 1], to = [1, 3] }]"
    inner = "piston=[{ inner = 'x', position = 12, velocity = 0.25 }]"
    effects = effects_of(wall, inner, "box.left={ thermal = 2 }", "log.pressure=true")[1]
    (record,) = effects.piston
    assert (record.x, record.v, record.a, record.m, record.length) == (12, 0.25, 0, 0, 20)
    assert (record.wall, record.axis, record.outward) == (5, 0, 0)
    assert (len(effects.segments), len(effects.wall_energy), len(effects.flow.hits)) == (1, 6, 4 + 2 * 2)
    assert effects.thermal.temperature.tolist() == [2, -1, -1, -1, -1, -1]
    inner = "piston=[{ inner = 'y', position = 8, mass = 3 }]"
    (record,) = effects_of(inner, "gravity.acceleration=[0, -0.125]")[1].piston
    assert (record.x, record.a, record.axis, record.wall, record.length) == (8, -0.125, 1, 4, 10)


@pytest.mark.parametrize(
    ("override", "kept"),
    [
        ("gravity.acceleration=[0, 1]", False),
        ("box.top={ thermal = 1 }", True),
        ("piston=[{ velocity = 0.25, position = 15 }]", True),
    ],
)
def test_an_account_is_kept_only_where_walls_can_give_or_take_energy(override, kept):
    assert (effects_of(override)[1].wall_energy is not None) == kept
