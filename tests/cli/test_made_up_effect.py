"""A new effect is two files and one line of the list: scenes, runs, checks, schema, energy and benchmark have it.

The package is copied, and the copy gets the effect; everything else in it is unchanged. Most tests run it interpreted.
"""

import json
import math
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

    from idealgas.effects.effect import BenchmarkSample, Effect
    from idealgas.effects.properties import Properties
    from idealgas.physics.tilt import tilted
    from idealgas.toml.issues import Issue
    from idealgas.toml.table import Number, Positive, Table


    class TiltTable(Table):
        """`[tilt]`: an acceleration by its strength and direction."""

        strength: Positive = Field(description="length/time²")
        angle: Number = Field(default=0.0, description="radians")


    class TiltEffect(Effect[float]):
        """An acceleration by its strength and direction."""

        name = "tilt"
        field = "tilt"
        key = "tilt"
        table = TiltTable
        description = "[tilt]: strength, angle"
        samples = (BenchmarkSample(tables=lambda side: "[tilt]\\nstrength = 0.01\\n"),)

        def properties(self, tables):
            return Properties(
                uniform=False,
                straight_flight=False,
                allows_monte_carlo=False,
                drives_discs=True,
                acceleration=tilted(tables.table.strength, tables.table.angle),
            )

        def check(self, tables):
            strength = tables.table.strength
            if strength > max(tables.size):
                yield Issue((("tilt", "strength"),), "too strong", str(strength), "at most the size of the box")

        def make(self, tables, start):
            return tables.table.strength


    EFFECT = TiltEffect()
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


def replace_once(path, old, new):
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))


def add_effect(copy, name, law, effect):
    """Add the two files of an effect and its line in the list to a copy of the package."""
    (copy / "idealgas" / "physics" / f"{name}.py").write_text(dedent(law).lstrip())
    (copy / "idealgas" / "effects" / f"{name}.py").write_text(dedent(effect).lstrip())
    last = '    "thermostat",\n'
    replace_once(copy / "idealgas" / "effects" / "__init__.py", last, f'{last}    "{name}",\n')


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Runs Python with a copy of the package that has the effect, in a folder with a scene."""
    copy, folder = tmp_path_factory.mktemp("package"), tmp_path_factory.mktemp("folder")
    run = package_copy(copy, folder, NUMBA_DISABLE_JIT="1")
    add_effect(copy, "tilt", LAW, EFFECT)
    (folder / "scene.toml").write_text(SCENE)
    return run


def test_it_runs_like_any_other(run):
    result = json.loads(run(PROGRAM))
    assert result["acceleration"] == pytest.approx([0.5 * 0.5403023058681398, 0.5 * 0.8414709848078965], rel=1e-15)
    assert result["effects"] == result["sample"] == ["tilt"]
    assert result["rows"] >= 120
    assert [result[name] for name in ("oracle", "resumed")] == [True] * 2
    assert "potential_energy" in result["parts"]
    assert abs(result["drift"]) < 1e-12
    assert "tilt" in result["bench"]
    assert result["error"].endswith("tilt.strength: too strong (got 9.0; allowed at most the size of the box)")


def test_commands_show_it(run):
    assert json.loads(run(COMMAND, "check", "scene.toml", "--json"))["effects"] == ["tilt"]
    assert json.loads(run(COMMAND, "schema"))["$defs"]["TiltTable"]["required"] == ["strength"]


@pytest.mark.long
def test_two_threads_share_its_work(run, tmp_path):
    (alone, together), same = json.loads(run(TWO_THREADS, NUMBA_DISABLE_JIT="0", NUMBA_CACHE_DIR=str(tmp_path)))
    assert alone == 0 < together
    assert same


DELTA_LAW = '''
    """Discs that part faster than their collision alone makes them.

    Brito, Risso & Soto, Phys. Rev. E 87, 022209 (2013).
    """

    import math

    from idealgas.jit import inline


    @inline
    def push_apart(a, b, x, y, delta):
        """Add 2 Δ to the relative velocity of two touching discs along (x, y), the position of a relative to b."""
        if delta is not None:
            share = 2.0 * delta / ((a.m + b.m) * math.sqrt(x * x + y * y))
            a.vx += share * b.m * x
            a.vy += share * b.m * y
            b.vx -= share * a.m * x
            b.vy -= share * a.m * y
'''
DELTA_EFFECT = '''
    """Collisions that give energy."""

    from pydantic import Field

    from idealgas.effects.effect import BenchmarkSample, Effect
    from idealgas.effects.properties import Properties
    from idealgas.toml.table import Positive, Table


    class DeltaTable(Table):
        """`[delta]`: speed that each of two equal discs gains along the line of centres."""

        speed: Positive = Field(description="length/time")


    class DeltaEffect(Effect[float]):
        """Collisions that give energy."""

        name = "delta"
        field = "delta"
        key = "delta"
        table = DeltaTable
        description = "[delta]: speed"
        samples = (BenchmarkSample(tables=lambda side: "[delta]\\nspeed = 0.001\\n"),)

        def properties(self, tables):
            return Properties(elastic=False, constant_restitution=False, collisions_give_energy=True)

        def make(self, tables, start):
            return tables.table.speed


    EFFECT = DeltaEffect()
'''
DELTA_SCENE = """
scene.seed = 11
box = { size = [56, 56], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic" }
species = [{ name = "gas", count = 400, radius = 0.5, temperature = 1.0 }]
restitution = { normal = 0.8 }
delta = { speed = 0.1 }
run.collisions_per_disc = 4000
"""


@pytest.mark.long
def test_a_gas_whose_collisions_give_energy_is_steady(tmp_path):
    """Restitution α takes ¼ m (1 - α²)⟨g²⟩ from a pair, Δ gives it m Δ² + m α Δ ⟨g⟩; g is the speed of approach.

    In a Maxwellian gas ⟨g⟩ = √(π T / m) and ⟨g²⟩ = 4 T / m. Deviations from it, of the order of a₂, are left out.
    """
    copy, folder = tmp_path / "package", tmp_path / "folder"
    copy.mkdir(), folder.mkdir()
    run = package_copy(copy, folder, NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    add_effect(copy, "delta", DELTA_LAW, DELTA_EFFECT)
    law = copy / "idealgas" / "physics" / "disc_disc.py"
    last = "    a.vx, a.vy, b.vx, b.vy = velocities_after(a, b, x, y, a.vx - b.vx, a.vy - b.vy, factor)\n"
    replace_once(law, last, f"{last}    push_apart(a, b, x, y, effects.delta)\n")
    first = "from idealgas.physics.restitution import"
    replace_once(law, first, f"from idealgas.physics.delta import push_apart\n{first}")
    (folder / "scene.toml").write_text(DELTA_SCENE)
    run(COMMAND, "run", "scene.toml", "-o", "run.h5")
    result = json.loads(run(COMMAND, "temperature", "run.h5", "--json"))
    alpha, delta = 0.8, 0.1
    half = alpha * delta * math.sqrt(math.pi) / (2 * (1 - alpha**2))
    theory = (half + math.sqrt(half**2 + delta**2 / (1 - alpha**2))) ** 2
    assert result["species"][0]["both"]["value"] == pytest.approx(theory, rel=0.03)
