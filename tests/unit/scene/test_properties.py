"""What effects change: which properties each takes away or brings, and how they come together."""

import math
from dataclasses import fields, replace
from itertools import combinations

import pytest

from idealgas.columns import FIRST_SEGMENT, OUTWARD, SIDES, axis_of, is_upper, opposite, side_ends, sides_across
from idealgas.effects.properties import Properties
from idealgas.physics.disc_wall import inward_normal
from idealgas.scene import parse_scene

pytestmark = pytest.mark.interpreted

PLAIN = """
box.size = [20, 10]
run.until = 4
species = [{ name = "gas", count = 12, radius = 0.2, temperature = 1, region = [0, 0, 15, 8] }]
"""
TABLES = {
    "gravity": ["gravity.acceleration=[0, -0.5]"],
    "periodic sides": ["box.left=periodic", "box.right=periodic"],
    "wall segments": ["wall=[{from=[16, 4], to=[18, 5]}]"],
    "rotation": ["rotation.roughness=1"],
    "restitution": ["restitution.normal=0.9"],
    "thermal walls": ["box.bottom={thermal=2}"],
    "piston": ["piston=[{side='top', position=9, velocity=0}]"],
    "thermostat": ["thermostat={temperature=3, rate=0.5}"],
    "non-interacting discs": ["interactions.discs=false"],
}
"""Each effect alone, in a form that goes with the others."""
NAMES = tuple(TABLES)


def scene(*overrides, text=PLAIN):
    return parse_scene(text, overrides=overrides)


def properties(*overrides):
    return scene(*overrides).properties


def together(*names):
    return [override for name in names for override in TABLES[name]]


def test_a_plain_box_has_all_defaults_and_all_effects_lack_several():
    assert properties() == Properties()
    assert scene().active_effects == ()
    assert scene().lacking("uniform", "isolated", "conserves_motion") == ()
    everything = scene(*together(*NAMES))
    kept = ("periodic sides", "non-interacting discs")
    assert everything.lacking("uniform", "conserves_motion") == tuple(e for e in NAMES if e not in kept)
    assert everything.lacking() == ()


LACKING = {
    "uniform": {"gravity", "wall segments", "restitution", "piston"},
    "straight_flight": {"gravity"},
    "elastic": {"restitution"},
    "collisions_conserve_energy": {"restitution"},
    "fixed_walls": {"piston"},
    "isolated": {"thermal walls", "thermostat"},
    "conserves_energy": {"gravity", "restitution", "piston"},
    "conserves_motion": {"gravity", "rotation", "restitution", "thermal walls", "piston", "thermostat"},
    "allows_monte_carlo": {
        "gravity",
        "periodic sides",
        "wall segments",
        "thermal walls",
        "piston",
        "thermostat",
        "non-interacting discs",
    },
    "allows_time_steps": {"wall segments", "piston", "thermostat", "non-interacting discs"},
    "interacting": {"non-interacting discs"},
    "is_scalable": {"wall segments", "piston"},
    "empty": {"wall segments"},
}
BRINGING = {
    "drives_discs": {"gravity", "piston", "thermostat"},
    "has_rough_walls": {"thermal walls"},
    "spins": {"rotation"},
    "driven": set(),
    "dissipative": {"restitution"},
}


@pytest.mark.parametrize("name", LACKING)
def test_what_effects_take_away(name):
    """From a scene with all of them, each alone, and in the order of NAMES."""
    everything = scene(*together(*NAMES))
    assert everything.effects == NAMES
    assert everything.lacking(name) == tuple(effect for effect in NAMES if effect in LACKING[name])
    assert not getattr(everything.properties, name)
    for effect in NAMES:
        assert getattr(properties(*TABLES[effect]), name) == (effect not in LACKING[name])


@pytest.mark.parametrize("name", BRINGING)
def test_what_effects_bring(name):
    for effect in NAMES:
        assert getattr(properties(*TABLES[effect]), name) == (effect in BRINGING[name])


@pytest.mark.parametrize(
    ("overrides", "changed"),
    [
        (["rotation.roughness=0.5"], {"dissipative": True, "inertia": 0.5}),
        (["rotation.wall_roughness=0.5"], {"dissipative": True, "inertia": 0.5, "has_rough_walls": True}),
        (["rotation.wall_roughness=1", "rotation.inertia=0.25"], {"inertia": 0.25, "has_rough_walls": True}),
        (["restitution.normal=1"], {}),
        (["restitution.wall=0.5"], {"uniform": False, "elastic": False, "dissipative": True}),
        (["box.top=periodic", "box.bottom=periodic"], {"allows_monte_carlo": False, "periodic": (False, True)}),
    ],
)
def test_what_keys_decide(overrides, changed):
    assert properties(*overrides) == replace(Properties(), **changed)


def test_drives_accelerations_and_temperatures():
    assert properties("piston=[{ velocity = -0.5 }]").driven
    assert not properties("piston=[{ velocity = 0 }]").driven
    each, other = (replace(Properties(), acceleration=a) for a in ((1.0, 0.0), (0.5, -2.0)))
    assert (each & other).acceleration == (1.5, -2.0)
    walls = "wall=[{from=[16, 4], to=[18, 5]}, {from=[16, 2], to=[18, 3], temperature=4}]"
    result = properties("box.right={thermal=2}", walls)
    assert result.emits == (None, 2.0, None, None, None, 4.0)
    assert result.temperatures == {2.0, 4.0}
    assert Properties().emits == (None,) * FIRST_SEGMENT
    assert properties("box.right={thermal=2}", *TABLES["thermostat"]).temperatures == {2.0, 3.0}
    assert all("combine" in entry.metadata for entry in fields(Properties))
    assert len(SIDES) == FIRST_SEGMENT == len(OUTWARD)


def wall(gate):
    return f"wall=[{{from=[16, 4], to=[18, 5], {gate}}}]"


@pytest.mark.parametrize(
    ("walls", "last_wall_removed_at"),
    [
        (wall("name='w'"), math.inf),
        (wall("opens_at=2"), 2.0),
        (wall("opens_at=2, closes_at=3"), math.inf),
        (wall("closes_at=3"), math.inf),
        ("wall=[{from=[16, 4], to=[18, 5], opens_at=2}, {from=[16, 2], to=[18, 3], opens_at=3}]", 3.0),
    ],
)
def test_when_the_box_is_clear_of_walls(walls, last_wall_removed_at):
    assert properties(walls).last_wall_removed_at == last_wall_removed_at
    assert not properties(walls).empty


X, Y = together("periodic sides"), ["box.top=periodic", "box.bottom=periodic"]


@pytest.mark.parametrize(
    ("overrides", "kept"),
    [
        ([], (False, False)),
        (X, (True, False)),
        (Y, (False, True)),
        (X + Y, (True, True)),
        (X + TABLES["wall segments"], (False, False)),
        (X + TABLES["thermal walls"], (False, False)),
        ([*X, "rotation.wall_roughness=0.5"], (False, False)),
        ([*X, "rotation.roughness=0.5"], (True, False)),
        ([*X, *Y, "rotation.wall_roughness=0.5"], (True, True)),
        ([*X, *Y, *TABLES["thermostat"]], (False, False)),
    ],
)
def test_along_which_axes_momentum_is_kept(overrides, kept):
    assert properties(*overrides).conserves_momentum == kept


@pytest.mark.parametrize("names", list(combinations(NAMES, 2)))
def test_effects_come_together(names):
    """Whichever comes first; the plain box adds nothing."""
    result, other = (properties(*TABLES[name]) for name in names)
    both = properties(*together(*names))
    assert replace(both, emits=both.emits[:FIRST_SEGMENT]) == result & other == other & result
    assert result & Properties() == Properties() & result == result


SPREAD = {"acceleration": (1.0, 0.0), "later_accelerations": ((-3.0, 0.5), (2.0, -0.25))}


@pytest.mark.parametrize(
    ("given", "name", "value"),
    [
        ({"periodic": (True, True), "shear": 0.5}, "conserves_momentum", (False, True)),
        ({"periodic": (True, True)}, "conserves_momentum", (True, True)),
        ({"periodic": (True, True), "acceleration": (0.0, -1.0)}, "conserves_momentum", (True, False)),
        ({"periodic": (True, True), "last_wall_removed_at": 3.0}, "conserves_momentum", (False, False)),
        (SPREAD, "strongest_pull", (-3.0, 0.5)),
        ({"periodic": (False, True), **SPREAD}, "free_fall_axes", (False, True)),
        ({"escapes": True}, "conserves_energy", False),
        ({"fixed_walls": False}, "conserves_energy", False),
        ({"inertia": 0.5}, "conserves_energy", True),
        ({"inertia": 0.5}, "conserves_motion", False),
        ({"bath": 2.0}, "conserves_motion", False),
        ({"later_temperatures": (3.0,), "emits": (None, 2.0, None, None)}, "temperatures", {2.0, 3.0}),
        ({"bath": 2.0}, "frictionless", False),
    ],
)
def test_what_follows_from_properties(given, name, value):
    assert getattr(Properties(**given), name) == value


# ── walls by their numbers ──


@pytest.mark.parametrize("side", range(len(SIDES)))
def test_sides_by_their_numbers(side):
    """Against the law that the engines take: a side's normal points out along its axis, up or down."""
    assert tuple(-n for n in inward_normal(side)) == OUTWARD[side]
    axis, sign = axis_of(side), 1.0 if is_upper(side) else -1.0
    assert OUTWARD[side][axis] == sign
    assert opposite(opposite(side)) == side
    assert {side, opposite(side)} == set(sides_across(axis))
    start, end = side_ends((20.0, 10.0))[side]
    assert start[axis] == end[axis] == ((20.0, 10.0)[axis] if is_upper(side) else 0.0)
    assert (start[1 - axis], end[1 - axis]) == (0.0, (20.0, 10.0)[1 - axis])


def test_a_changed_copy_of_a_scene_has_other_effects():
    """Effects are found once for the same tables; a copy with another end of its run has the same tables."""
    plain, fallen = scene(), scene(*TABLES["gravity"])
    longer = plain.model_copy(update={"run": fallen.run})
    assert longer.active_effects is plain.active_effects
    falling = plain.model_copy(update={"gravity": fallen.gravity})
    assert (falling.effects, falling.properties.acceleration) == (("gravity",), (0.0, -0.5))
    periodic = plain.model_copy(update={"box": scene(*TABLES["periodic sides"]).box})
    assert (periodic.properties.periodic, periodic.properties.acceleration) == ((True, False), (0.0, 0.0))
    assert (plain.properties.periodic, plain.effects) == ((False, False), ())
