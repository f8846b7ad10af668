"""A new effect is two files and one line of the list: scenes, runs, checks, schema, energy and benchmark have it.

The package is copied, and the copy gets the effect; everything else in it is unchanged. Most tests run it interpreted.
"""

import json
from textwrap import dedent

import pytest
from helpers.fresh_python import COMMAND, package_copy

pytestmark = pytest.mark.slow

LAW = '''
    """The acceleration of a box that is tilted."""

    import math


    def tilted(strength, angle):
        """Acceleration (x, y) of a strength (length/time²) in a direction (radians)."""
        return strength * math.cos(angle), strength * math.sin(angle)
'''
EFFECT = '''
    """A tilted box."""

    from pydantic import Field

    from idealgas.effects.effect import EffectSpec, Sample
    from idealgas.effects.properties import Properties
    from idealgas.physics.tilt import tilted
    from idealgas.toml.issues import Issue
    from idealgas.toml.table import Number, Positive, Table


    class Tilt(Table):
        """`[tilt]`: an acceleration by its strength and direction."""

        strength: Positive = Field(description="length/time²")
        angle: Number = Field(default=0.0, description="radians")


    def properties(tables):
        return Properties(
            uniform=False,
            straight_flight=False,
            allows_monte_carlo=False,
            drives_discs=True,
            acceleration=tilted(tables.own.strength, tables.own.angle),
        )


    def check(tables):
        if tables.own.strength > max(tables.size):
            yield Issue((("tilt", "strength"),), "too strong", str(tables.own.strength), "at most the size of the box")


    EFFECT = EffectSpec(
        name="tilt",
        field="tilt",
        key="tilt",
        table=Tilt,
        description="[tilt]: strength, angle",
        properties=properties,
        check=check,
        make=lambda tables, start: tables.own.strength,
        samples=(Sample(tables=lambda side: "[tilt]\\nstrength = 0.01\\n"),),
    )
'''
SCENE = """
scene.seed = 3
box.size = [8, 8]
species = [{ name = "gas", count = 12, radius = 0.3, temperature = 1.0 }]
tilt = { strength = 0.5, angle = 1.0 }
run.events = 120
"""
PROGRAM = """
import json, math
import numpy as np
from idealgas.bench.effects import SCENES, effect_scene
from idealgas.log import open_log
from idealgas.run.resume import resume
from idealgas.run.simulate import simulate
from idealgas.scene import SceneError, load_scene

def events(path):
    with open_log(path) as log:
        return {name: np.concatenate(parts) for name, parts in zip(log.columns, zip(*log.chunks()))}

def same(path):
    return all(np.array_equal(column, whole[name]) for name, column in events(path).items())

summary = simulate(load_scene("scene.toml"), "run.h5")
whole = events("run.h5")
simulate(load_scene("scene.toml", ["run.method=brute_force"]), "oracle.h5")
simulate(load_scene("scene.toml", ["run.events=50"]), "resumed.h5")
resume("resumed.h5", ["run.events=120"])
with open_log("run.h5") as log:
    found = {
        "acceleration": list(log.gravity),
        "parts": sorted(log.observables),
        "rows": len(log),
        "effects": list(log.scene.effects),
    }
try:
    load_scene("scene.toml", ["tilt.strength=9"])
except SceneError as error:
    found["error"] = str(error)
found |= {name: same(f"{name}.h5") for name in ("oracle", "resumed")}
found |= {"drift": summary.energy_drift, "bench": list(SCENES), "sample": list(effect_scene("tilt", 1).effects)}
print(json.dumps(found))
"""
TWO_THREADS = """
import json
import numpy as np
from idealgas.log import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import load_scene

LARGE = ["box.size=[200, 200]", "species.count=12000", "tilt.strength=0.01", "run.events=600000"]

def events(path):
    with open_log(path) as log:
        return {name: np.concatenate([getattr(part, name) for part in log.chunks()]) for name in log.columns}

shared = [simulate(load_scene("scene.toml", [*LARGE, f"run.threads={n}"]), f"{n}.h5").shared_slices for n in (1, 2)]
alone, together = events("1.h5"), events("2.h5")
print(json.dumps([shared, all(np.array_equal(column, together[name]) for name, column in alone.items())]))
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Runs Python with a copy of the package that has the effect, in a folder with a scene."""
    copy, folder = tmp_path_factory.mktemp("package"), tmp_path_factory.mktemp("folder")
    run = package_copy(copy, folder, NUMBA_DISABLE_JIT="1")
    (copy / "idealgas" / "physics" / "tilt.py").write_text(dedent(LAW).lstrip())
    (copy / "idealgas" / "effects" / "tilt.py").write_text(dedent(EFFECT).lstrip())
    names = copy / "idealgas" / "effects" / "__init__.py"
    last = '    "thermostat",\n'
    assert names.read_text().count(last) == 1
    names.write_text(names.read_text().replace(last, last + '    "tilt",\n'))
    (folder / "scene.toml").write_text(SCENE)
    return run


def test_it_runs_like_any_other(run):
    found = json.loads(run(PROGRAM))
    assert found["acceleration"] == pytest.approx([0.5 * 0.5403023058681398, 0.5 * 0.8414709848078965], rel=1e-15)
    assert found["effects"] == found["sample"] == ["tilt"]
    assert found["rows"] >= 120
    assert [found[name] for name in ("oracle", "resumed")] == [True] * 2
    assert "potential_energy" in found["parts"]
    assert abs(found["drift"]) < 1e-12
    assert "tilt" in found["bench"]
    assert found["error"].endswith("tilt.strength: too strong (got 9.0; allowed at most the size of the box)")


def test_commands_show_it(run):
    assert json.loads(run(COMMAND, "check", "scene.toml", "--json"))["effects"] == ["tilt"]
    assert json.loads(run(COMMAND, "schema"))["$defs"]["Tilt"]["required"] == ["strength"]


@pytest.mark.long
def test_two_threads_share_its_work(run, tmp_path):
    (alone, together), same = json.loads(run(TWO_THREADS, NUMBA_DISABLE_JIT="0", NUMBA_CACHE_DIR=str(tmp_path)))
    assert alone == 0 < together
    assert same
