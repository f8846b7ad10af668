"""Absent effects leave no machine code behind: from a cold cache, numba compiles what it needs and nothing else."""

import json
import os
import subprocess
import sys

import pytest

from idealgas.effects import EFFECT_NAMES
from idealgas.effects.bundle import Effects

pytestmark = pytest.mark.slow

MARKERS = {
    "gravity": {"crossings.accelerated_crossing", "motion.time_to_plane", "wall.accelerated_body_delay"},
    "periodic sides": {"periodic.images_between", "state.record_image", "periodic.wrapped"},
    "sheared sides": {"shear.cross", "neighbours.append_sheared_row"},
    "wall segments": {"wall.segment_contact", "wall.segment_normal"},
    "arcs": {"arc.arc_contact", "arc.arc_frame"},
    "permeable walls": {"permeable.closed_face_delay", "permeable.touches_face"},
    "absorbing walls": {"resolve.absorb", "absorbing.leave_gas"},
    "rotation": {"rotation.tangential_impulse", "rotation.tangential_impulse_at_wall"},
    "thermal walls": {"thermal.uniform"},
    "vibrating sides": {"vibration.vibrating_contact", "vibration.side_velocity"},
    "piston": {"piston.advance_piston", "piston.piston_contact", "piston.collide_with_piston"},
    "thermostat": {"thermostat.uniform", "thermostat.andersen_collision"},
}
"""Functions that only make sense with an effect. Restitution has none, as its numbers would be
read in those of others; steering none, as it happens between epochs; and discs that do not interact none, as they only
lack events."""

PROGRAM = """
import gc, json, sys
from idealgas.bench.effects import effect_scene
from idealgas.engine.event_driven.kernel import advance_events
from idealgas.jit import EntryPoint
from idealgas.run.simulate import simulate

called = set()
if sys.argv[2] != "none":
    sys.setprofile(lambda frame, event, _: called.add((frame.f_globals.get("__name__"), frame.f_code.co_name)))
simulate(effect_scene(None, 300) if sys.argv[2] == "none" else effect_scene(sys.argv[2], 4000), sys.argv[1])
sys.setprofile(None)
names = {f"{module.rpartition('.')[2]}.{name}" for module, name in called if module and name}
compiled = [keys for each in gc.get_objects() if isinstance(each, EntryPoint) for keys in each.reached.values()]
names |= {".".join(key.split(".")[-2:]) for keys in compiled for key in keys}
types = [str(kind) for signature in getattr(advance_events, "reached", ()) for kind in signature[2].types]
print(json.dumps([sorted(names), types]))
"""


def run(folder, effects: str, **environment: str) -> tuple[set[str], list[str]]:
    """Functions that were compiled (or, with effects, interpreted) in a run, and the types of its effects."""
    variables = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "cache"), **environment}
    command = [sys.executable, "-W", "ignore", "-c", PROGRAM, str(folder / "run.h5"), effects]
    result = subprocess.run(command, env=variables, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    names, types = json.loads(result.stdout)
    return set(names), types


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """A plain box, compiled without optimisation, which takes half of the time."""
    return run(tmp_path_factory.mktemp("plain"), "none", NUMBA_OPT="0", NUMBA_DISABLE_JIT="0")


def test_all_effects_are_none_for_the_kernel(plain):
    _, types = plain
    assert types == ["none"] * len(Effects._fields)


@pytest.mark.parametrize("effect", MARKERS)
def test_nothing_of_an_absent_effect_is_compiled(plain, effect):
    compiled, _ = plain
    assert {"kernel.predict", "disc_disc.collision_time"} <= compiled
    assert not compiled & MARKERS[effect]


def test_with_the_effects_the_same_functions_run(tmp_path):
    """What the names above are worth: each is called where its effect is."""
    called, _ = run(tmp_path, "all", NUMBA_DISABLE_JIT="1")
    (tmp_path / "shear").mkdir()
    sheared, _ = run(tmp_path / "shear", "sheared sides", NUMBA_DISABLE_JIT="1")
    assert set().union(*MARKERS.values()) <= called | sheared
    assert set(MARKERS) | {"restitution", "steering", "non-interacting discs"} == set(EFFECT_NAMES)
