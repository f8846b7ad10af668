"""Numbers at the edge of what a float holds: a scene is refused line by line, or its run comes to its end."""

import tempfile
from pathlib import Path

import pytest
from helpers.support import called
from hypothesis import HealthCheck, Phase, example, given, settings
from hypothesis import strategies as st

from idealgas.toml.dump import toml_value
from idealgas.toml.table import LARGEST, SMALLEST

EVENTS = 100
edges = st.sampled_from([SMALLEST, LARGEST, 1e-30, 1e20, 0.0, 5e-324, 1e-200, 1e300])
numbers = st.integers(0, 9).flatmap(lambda k: edges if k == 9 else st.sampled_from([1.0, 1.0, 0.3, 1e-9, 1e9]))
signed = st.builds(float.__mul__, numbers, st.sampled_from([1.0, -1.0]))


@st.composite
def species(draw, width):
    """Discs of one kind; their radius is often a share of the box's width, up to all of it."""
    radius = draw(st.sampled_from([0.05, 0.5, 0.5 - 2.0**-53, 1e-9]).map(lambda share: share * width) | edges)
    motion = draw(st.sampled_from(["temperature", "speed"]))
    table = {"name": "gas", "count": draw(st.integers(1, 4)), "radius": radius, motion: draw(numbers)}
    return table | draw(st.fixed_dictionaries({}, optional={"mass": numbers, "placement": st.just("lattice")}))


@st.composite
def discs(draw, size):
    """Two discs, the first in the middle, the second in a corner: they may touch, each other and the sides."""
    share = draw(st.sampled_from([0.25, 0.1, 0.5, 1e-9]))
    radius = share * min(size)
    places = [[0.5 * size[0], 0.5 * size[1]], [size[0] - radius, radius]][: draw(st.integers(1, 2))]
    return [{"position": place, "radius": radius, "velocity": [draw(signed), draw(signed)]} for place in places]


def method_tables(draw):
    """A method with the numbers that only it has."""
    method = draw(st.sampled_from(["event_driven", "event_driven", "brute_force", "time_driven", "monte_carlo"]))
    own = {
        "time_driven": {"dt": draw(st.sampled_from([1.0, 0.1, 1e-3]) | edges)},
        "monte_carlo": {"v_ref": draw(st.sampled_from([1.0, 10.0, 1e4]) | edges)},
    }
    return {"method": method, "events": EVENTS} | own.get(method, {})


@st.composite
def scenes(draw, effects):
    """A scene with numbers of any size; effects: whether it may have any, each of which needs machine code."""
    size = [draw(numbers), draw(numbers)] if draw(st.booleans()) else [draw(numbers)] * 2
    tables = {"box": {"size": size}, "run": method_tables(draw), "log": {}}
    if draw(st.booleans()):
        tables["species"] = [draw(species(min(size)))]
    else:
        tables["disc"] = draw(discs(size))
    tables["run"] |= draw(st.fixed_dictionaries({}, optional={"until": numbers, "collisions_per_disc": numbers}))
    tables["log"] |= draw(st.fixed_dictionaries({}, optional={"snapshot_every": numbers}))
    for name, keys in EFFECTS.items() if effects else ():
        if draw(st.integers(0, 5)) == 0:
            tables[name] = draw(st.fixed_dictionaries(keys))
    return "".join(f"{name} = {toml_value(table)}\n" for name, table in tables.items())


EFFECTS = {
    "gravity": {"acceleration": st.builds(lambda pull: [0.0, pull], signed)},
    "rotation": {"inertia": numbers, "roughness": signed},
    "restitution": {"normal": numbers, "wall": numbers, "contact_duration": numbers},
    "piston": {"mass": numbers, "pressure": numbers},
}
quick = settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


def check(text, folder):
    """Write a scene and check it: whether it is valid; if not, each line names the file."""
    path = folder / "extreme.toml"
    path.write_text(text)
    done = called("check", path)
    assert done.returncode in (0, 2)
    lines = done.stderr.splitlines()
    assert all(line.startswith(f"{path}:") for line in lines)
    assert bool(lines) == (done.returncode == 2)
    return not lines


def run(text, folder):
    """Check a scene, and run it if it is valid; infinitely many events at one instant are refused by one line."""
    if check(text, folder):
        done = called("run", folder / "extreme.toml", "-o", folder / "extreme.h5", "--force")
        assert done.returncode in (0, 2), done.stderr
        assert done.returncode == 0 or done.stderr.splitlines()[-1].startswith(("after t = ", str(folder), "run."))


BOX = "box.size = [1, 1]\nrun.events = 9\n"
WIDE = f"{BOX}disc = [{{position = [0.5, 0.5], radius = 0.5, velocity = [1, 0]}}]\n"


def gas(motion, radius=0.01):
    """A scene of three discs."""
    return f'{BOX}species = [{{name = "gas", count = 3, radius = {radius}, {motion}}}]\n'


@given(scenes(effects=True))
@example(gas("speed = 1e-200"))
@example(gas("speed = 5e-324"))
@example(gas("speed = 1, mass = 1e-300"))
@example(gas("speed = 1", radius=1e-9))
@example(WIDE)
@example(WIDE + "gravity.acceleration = [0, -1]")
@quick
def test_a_check_says_yes_or_what_is_wrong(text):
    with tempfile.TemporaryDirectory() as folder:
        check(text, Path(folder))


PAIR = """box.size = [1, 1]
disc = [
    {position = [0.25, 0.5], radius = 0.25, velocity = [%(v)g, 0.1]},
    {position = [0.75, 0.5], radius = 0.25, velocity = [-%(v)g, 0.1]},
]
"""


@given(scenes(effects=False))
@example(gas("speed = 1") + "run.collisions_per_disc = 1e30\n")
@example(PAIR % {"v": SMALLEST} + "run.until = 1\n")
@example(PAIR % {"v": 1} + "run.until = 1\n")
@example(WIDE.replace("run.events = 9", "run.until = 1"))
@example(WIDE.replace("velocity = [1, 0]", "velocity = [0, 0]").replace("run.events = 9", "run.until = 1"))
@settings(phases=[Phase.explicit])  # what is drawn may have ten million snapshots
@pytest.mark.slow
def test_a_run_ends(text):
    with tempfile.TemporaryDirectory() as folder:
        run(text, Path(folder))


@given(scenes(effects=True))
@settings(quick, max_examples=2_000)
@pytest.mark.long
def test_runs_with_any_effects_end(text):
    with tempfile.TemporaryDirectory() as folder:
        run(text, Path(folder))
