"""States that effects make of their tables, what they add to the energy, and how they change: by hand."""

import math

import numpy as np
import pytest

from idealgas.effects.bundle import energy_parts
from idealgas.effects.vibration import reach
from idealgas.initial.build import make_gas
from idealgas.physics.permeable import FROM_LEFT, FROM_RIGHT, OPEN, SOLID
from idealgas.physics.stress import COLLISIONAL, KINETIC
from idealgas.run.effects import make_effects
from idealgas.run.energy import energy_of
from idealgas.scene import parse_scene

pytestmark = pytest.mark.interpreted

DISCS = """
box.size = [10, 8]
run.until = 10
disc = [
    { position = [2, 3], velocity = [1, -2], radius = 0.5, mass = 3 },
    { position = [6, 5], velocity = [0, 0.5], radius = 0.25 },
]
"""


def made(text, *overrides):
    """The gas and the effects of a scene at time 0."""
    scene = parse_scene(DISCS + text, overrides=overrides)
    gas = make_gas(scene)
    return gas, make_effects(scene, gas)


def test_spins_and_gravity_have_an_energy():
    """-3 (0.5 · 2 - 3) - (0.5 · 6 - 5): 6 + 2."""
    gas, effects = made("gravity.acceleration = [[0, [0.5, -1]], [3, [0, -2]]]")
    assert energy_parts(effects, gas) == {"potential": 8.0}
    assert tuple(effects.gravity) == (0.5, -1.0)
    assert [(time, item, value) for time, _, item, value in effects.schedule] == [(3.0, 0, 0.0), (3.0, 1, -2.0)]
    gas, effects = made('gravity.acceleration = [0.5, 0]\nbox.left = "periodic"\nbox.right = "periodic"')
    effects.periodic.image[1] = (2, 0)
    assert energy_parts(effects, gas) == {"potential": -0.5 * (3 * 2 + 26)}
    # κ m R² = 0.4 · 3/4 and 0.4/16.
    gas, effects = made("rotation = { inertia = 0.4 }\n", "disc.0.angular_velocity=2", "disc.1.angular_velocity=-4")
    assert effects.rotation.inertia == pytest.approx([0.3, 0.025], rel=1e-15)
    assert energy_parts(effects, gas) == {"rotational": pytest.approx(0.5 * 0.3 * 4 + 0.5 * 0.025 * 16, rel=1e-14)}
    hot = 'species = [{ name = "hot", count = 9, radius = 0.1, temperature = 1, spin_temperature = 2.5 }]\n'
    _, effects = made("rotation = { inertia = 0.5, wall_roughness = 0 }\n" + hot)
    spins = effects.rotation.omega[2:]
    assert effects.rotation.omega[:2].tolist() == [0.0, 0.0]
    assert (0.5 * 0.01 * spins**2).mean() == pytest.approx(2.5, rel=1e-12)


@pytest.mark.parametrize(
    ("keys", "walls", "losses"),
    [
        ("roughness = 1", False, False),
        ("roughness = 0.5", False, True),
        ("roughness = 1, wall_roughness = 0.5", True, True),
        ("roughness = 1, wall_roughness = 1", False, False),
    ],
)
def test_which_rough_discs_lose_energy(keys, walls, losses):
    _, effects = made(f"rotation = {{ {keys} }}")
    assert (effects.wall_energy is not None, effects.dissipated is not None) == (walls, losses)


@pytest.mark.parametrize(
    ("normal", "wall", "gives", "loses"), [(0.9, 1, False, True), (1, 0.9, True, True), (1, 1, None, None)]
)
def test_which_inelastic_discs_lose_energy(normal, wall, gives, loses):
    _, effects = made(f"restitution = {{ normal = {normal}, wall = {wall}, contact_duration = 0.01 }}")
    if gives is None:
        assert effects.restitution is None
    else:
        assert (effects.wall_energy is not None, effects.dissipated is not None) == (gives, loses)
        assert effects.restitution[:3] == (normal, wall, 0.01)
        assert effects.restitution.last.tolist() == [-math.inf] * 2


def test_a_vibrating_side_reaches_twice_its_amplitude_in_half_a_period():
    """a = 8 A/half²: ½ a (half/2)² = A, where the acceleration turns round."""
    _, effects = made("box.bottom = { vibrating = { amplitude = 0.1, frequency = 0.25 } }")
    side = effects.vibration[2]
    assert (side.amplitude, side.half, side.start) == (0.1, 2.0, 0.0)
    assert side.acceleration == pytest.approx(0.2, rel=1e-15)
    assert effects.vibration.amplitude.tolist() == [0.0, 0.0, 0.1, 0.0]
    other = parse_scene(DISCS + "box.bottom = { vibrating = { amplitude = 0.1, frequency = 1 } }")
    assert reach(other.box.bottom) == 0.2


def test_a_pressed_piston_and_an_inner_one():
    """At the top, of mass 4 under 0.3 · 10 and gravity -1: A = -1 - 3/4; energy M (V²/2 - A X), and it is counted."""
    text = "gravity.acceleration = [0, -1]\n" + 'piston = [{ side = "top", position = 7, mass = 4, pressure = 0.3 }]\n'
    gas, effects = made(text)
    (piston,) = effects.piston
    assert (piston.x, piston.v, piston.a, piston.m, piston.length, piston.outward) == (7.0, 0.0, -1.75, 4.0, 8.0, 1.0)
    assert (piston.wall, piston.axis) == (3, 1)
    assert energy_parts(effects, gas)["piston"] == pytest.approx(4 * 1.75 * 7, rel=1e-15)
    piston.v = 2.0
    assert energy_parts(effects, gas, 0.5)["piston"] == pytest.approx(8 + 4 * 1.75 * 7, rel=1e-14)  # conserved
    below = 'piston = [{ side = "bottom", position = 0.25, mass = 4, pressure = 0.5 }]'
    (piston,) = made(below, "gravity.acceleration=[0, 0.125]")[1].piston
    assert (piston.a, piston.outward, piston.wall, piston.axis) == (0.5 * 10 / 4 + 0.125, -1.0, 2, 1)
    moved = made('piston = [{ side = "left", position = 1, velocity = [[0, 0.5], [2, 0], [4, -0.25]] }]')[1]
    assert (moved.piston[0].outward, moved.piston[0].v, moved.piston[0].m) == (-1.0, 0.5, 0.0)
    assert [(time, item, value) for time, _, item, value in moved.schedule] == [(2.0, 1, 0.0), (4.0, 1, -0.25)]
    assert "piston" not in {name: e for name, e in energy_parts(moved, gas).items() if e}
    scene = parse_scene(DISCS + 'piston = [{ inner = "x", mass = 2 }]')
    gas = make_gas(scene)
    effects = make_effects(scene, gas)
    (record,), (table,) = effects.piston, scene.piston
    assert (record.x, record.a, record.outward, record.wall, record.axis) == (5.0, 0.0, 0.0, 4, 0)
    assert table.outward_from(gas.position, scene.box.size).tolist() == [1.0, -1.0]


def test_gates_follow_their_schedule():
    twice = "{ from = [4, 1], to = [4, 2], opens_at = [2, 6], closes_at = 4 }"
    _, effects = made(f"wall = [{twice}, {{ from = [8, 1], to = [8, 2], closes_at = 3 }}]")
    assert effects.segments.active.tolist() == [True, False]
    assert [(time, item, value) for time, _, item, value in effects.schedule] == [
        (2.0, 0, 0.0), (3.0, 1, 1.0), (4.0, 0, 1.0), (6.0, 0, 0.0)
    ]  # fmt: skip


def test_sums_of_the_flow_of_momentum():
    """Faces of four sides and two of each wall; the centre of the box; the motion of the whole gas for the heat."""
    _, effects = made("log.pressure = true\nwall = [{ from = [4, 1], to = [4, 2] }]")
    assert (len(effects.flow.normal_impulse), len(effects.flow.hits)) == (6, 6)
    assert (effects.flow.x, effects.flow.y) == (5.0, 4.0)
    sides = "".join(f'box.{side} = "periodic"\n' for side in ("left", "right", "bottom", "top"))
    flow = made("log = { pressure = true, heat_flow = true }\n" + sides)[1].flow
    assert (flow.vx, flow.vy) == (3 / 4, -5.5 / 4)
    assert (len(flow.tensor[KINETIC]), len(flow.tensor[COLLISIONAL]), len(flow.heat)) == (3, 3, 4)


def test_kinetic_energy_and_its_account_at_time_0():
    gas, effects = made("thermostat = { temperature = 2, rate = 1 }\nbox.left = { thermal = 2 }")
    energy = energy_of(gas, effects)
    assert (energy.kinetic, energy.given, energy.lost, energy.balance) == (7.625, 0.0, 0.0, 7.625)
    assert np.all(effects.thermostat.time > 0)
    assert effects.thermal.temperature.tolist() == [2.0, -1.0, -1.0, -1.0]


def test_walls_let_species_pass_as_their_tables_say():
    """A wall upwards: from the left is from its left; downwards, from its right. The sides of the box are no walls."""
    walls = """
    species = [
        { name = "a", count = 1, radius = 0.1, temperature = 1 },
        { name = "b", count = 1, radius = 0.1, temperature = 1 },
    ]
    wall = [
        { from = [4, 1], to = [4, 7] },
        { from = [4, 1], to = [4, 7], permeable_to = ["b"] },
        { from = [4, 1], to = [4, 7], permeable_from = "left" },
        { from = [4, 7], to = [4, 1], permeable_from = "left", permeable_to = ["a"] },
    ]
    """
    gas, effects = made(walls)
    names = dict(enumerate(gas.species_names))
    passes = {name: effects.permeable.passage[:, k].tolist() for k, name in names.items()}
    assert passes["a"] == [SOLID, SOLID, FROM_LEFT, FROM_RIGHT]
    assert passes["b"] == [SOLID, OPEN, FROM_LEFT, SOLID]
    assert effects.permeable.species.tolist() == gas.species.tolist()
