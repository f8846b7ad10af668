"""Runs that start from a state of a log, of a file or of a Python program."""

import json
import re

import numpy as np
import pytest
from helpers.log_compare import differences
from helpers.support import called, error_of, logged, output_of

from idealgas import Scene, SceneError, UserError, load_scene, open_log, parse_scene, resume, simulate
from idealgas.columns import Kind
from idealgas.log.start import continued_scene
from idealgas.toml.dump import dump_document

GAS = """
scene.seed = 7
box.size = [8.0, 6.0]
run.events = 4000
[[species]]
name = "light"
count = 30
radius = 0.2
temperature = 1
[[species]]
name = "heavy"
count = 10
radius = 0.4
mass = 5
temperature = 1
placement = "lattice"
"""

EFFECTS = {
    "none": "",
    "gravity": "gravity.acceleration = [0, -0.5]\n",
    "periodic": 'box.left = "periodic"\nbox.right = "periodic"\n',
    "rotation": "rotation.roughness = 0.5\n",
    "lossy": "restitution.normal = 0.9\n",
    "piston": 'piston = [{ side = "right", mass = 50, pressure = 4 }]\n',
    "pistons": 'piston = [{ side = "left", mass = 50, pressure = 4 }, { inner = "x", mass = 5 }, { velocity = 0 }]\n',
    "wall": "wall = [{ from = [4, 0], to = [4, 6], opens_at = 0.5 }, { from = [2, 0], to = [2, 1] }]\n",
    "brute force": 'run.method = "brute_force"\n',
}


def rows_of(log, first=0, stop=None):
    """Event rows of a log in one block."""
    parts = list(log.chunks(None, first, stop))
    return {name: np.concatenate([getattr(part, name) for part in parts]) for name in log.columns}


@pytest.fixture(scope="module")
def old(tmp_path_factory):
    """Log of the plain gas."""
    path = tmp_path_factory.mktemp("old") / "old.h5"
    simulate(parse_scene(GAS), path)
    return path


@pytest.mark.parametrize("effect", EFFECTS)
def test_a_start_from_a_checkpoint_goes_on_bit_for_bit(tmp_path, effect):
    """All discs are at one time there: clocks count from it in both runs, only the origin of time differs."""
    with logged(parse_scene(EFFECTS[effect] + GAS), tmp_path / "old.h5") as log:
        k = len(log.checkpoints) // 2
        at, row = log.checkpoints.times[k].item(), log.checkpoints.rows[k].item()
        expected = rows_of(log, row)
    assert len(expected["time"]) > 1000
    output_of("scene", tmp_path / "old.h5", "--at", repr(at), "-o", tmp_path / "next.toml")
    with logged(load_scene(tmp_path / "next.toml", ["run.events=1500"]), tmp_path / "new.h5") as log:
        result = rows_of(log)
    n = min(len(result["time"]), len(expected["time"])) - 10
    for name in ("disc", "partner", "kind", "position", "velocity", "angular_velocity"):
        if name in result and not (effect == "wall" and name == "partner"):  # the first wall has been removed
            assert np.array_equal(result[name][:n], expected[name][:n]), name
    assert np.abs(result["time"][:n] + at - expected["time"][:n]).max() <= 2**-51 * expected["time"][n]


def test_a_start_from_the_end_has_the_same_next_events(tmp_path, old):
    """Within an epoch discs are brought to one time, which rounds each position: the last digits part, not the events.

    An error of 10⁻¹⁵ grows about tenfold in three collisions of each disc: less in 20 events of 40 discs.
    """
    output_of("scene", old, "-o", tmp_path / "next.toml")
    simulate(load_scene(tmp_path / "next.toml", ["run.events=20"]), tmp_path / "new.h5")
    longer = tmp_path / "longer.h5"
    longer.write_bytes(old.read_bytes())
    resume(longer, ["run.events=4020"])
    with open_log(tmp_path / "new.h5") as new, open_log(longer) as log, open_log(old) as before:
        result, expected, end = rows_of(new), rows_of(log, len(before)), before.end_time
    assert np.array_equal(result["disc"], expected["disc"])
    assert np.array_equal(result["partner"], expected["partner"])
    assert np.abs(result["time"] + end - expected["time"]).max() < 1e-12


def test_the_new_log_needs_the_old_one_no_more(tmp_path):
    simulate(parse_scene(GAS), tmp_path / "old.h5")
    (tmp_path / "next.toml").write_text(f"{GAS}[start]\nlog = 'old.h5'\n")
    scene = load_scene(tmp_path / "next.toml")
    simulate(scene, tmp_path / "whole.h5")
    simulate(load_scene(tmp_path / "next.toml", ["run.events=2500"]), tmp_path / "new.h5")
    with open_log(tmp_path / "old.h5") as log:
        state = log.state_at(log.end_time)
    (tmp_path / "old.h5").unlink()
    resume(tmp_path / "new.h5", ["run.events=4000"])
    assert differences(tmp_path / "whole.h5", tmp_path / "new.h5") == []
    with open_log(tmp_path / "new.h5") as log:
        assert log.scene == scene
        assert np.array_equal(log.discs.position, state.position)
        assert np.array_equal(log.discs.velocity, state.velocity)
        assert log.scene.start.log == str(tmp_path / "old.h5")
        assert re.fullmatch("[0-9a-f]{32}", log.scene.start.digest)
    assert "light" in output_of("temperature", tmp_path / "new.h5")
    assert "start.log: cannot be started from" in error_of("check", tmp_path / "next.toml")


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize(
    ("effect", "allowed", "at", "message"),
    [
        (  # the images above are ahead by 0.5 * 4 * t, a multiple of 6 at t = 3
            "box={left='periodic',right='periodic',bottom={shear=0.5},top={shear=0.5},size=[6,4]}",
            3.0,
            2.0,
            r"from t = 2 \(allowed multiples of 3, at which the periodic images",
        ),
        (
            "box.size=[6,4]\npiston=[{side='right',mass=50,pressure=4}]\nlog.snapshot_every=0.75",
            1.5,
            1.4,
            r"not at t = 1.4; the nearest is t = 1.5$",
        ),
    ],
    ids=["sheared sides", "piston"],
)
def test_without_a_state_to_start_from_the_nearest_is_named(tmp_path, effect, allowed, at, message):
    text = f"{effect}\nrun.until=3.2\nspecies=[{{name='gas',count=5,radius=0.2,temperature=1}}]\n"
    with logged(parse_scene(text), tmp_path / "old.h5") as log:
        assert f"time = {allowed}\n" in continued_scene(log, allowed, "old.h5")
        with pytest.raises(UserError, match=message):
            continued_scene(log, at, "old.h5")


def test_every_state_of_a_log_is_a_start(old):
    """Also between events and at the instant of one, where two discs are in contact."""
    with open_log(old) as log:
        instants = [0.0, *np.linspace(0.1, 0.9, 10) * log.end_time, *rows_of(log)["time"][100:400:10]]
    for instant in instants:
        parse_scene(f"{GAS}[start]\nlog = '{old}'\ntime = {float(instant)!r}\n")


def test_a_state_of_time_steps_is_a_start_with_its_overlaps(tmp_path):
    steps = GAS + '[run]\nmethod = "time_driven"\ndt = 0.05\nuntil = 2\n'
    with logged(parse_scene(steps.replace("run.events = 4000\n", "")), tmp_path / "old.h5") as log:
        rows = rows_of(log)
    at = float(rows["time"][rows["kind"] == Kind.DISC][0])
    scene = parse_scene(f"{GAS}[start]\nlog = '{tmp_path / 'old.h5'}'\ntime = {at!r}\n")
    assert 1e-3 < scene.start.overlap < 0.4
    simulate(scene, tmp_path / "new.h5")


@pytest.mark.parametrize("method", ["event_driven", "brute_force"])
def test_velocities_are_kept_reversed_or_new(tmp_path, old, method):
    starts = {}
    for velocities in ("keep", "reversed", "new"):
        text = f"{GAS}[start]\nlog = '{old}'\nvelocities = '{velocities}'\n"
        with logged(parse_scene(text, overrides=[f"run.method={method}"]), tmp_path / f"{velocities}.h5") as log:
            starts[velocities] = log.discs
            assert log.scene.start.velocities == velocities
    keep, back, new = starts.values()
    assert np.array_equal(back.velocity, -keep.velocity)
    assert np.array_equal(new.position, keep.position)
    assert new.kinetic_energy == pytest.approx(40)  # temperature 1
    assert not np.isclose(new.velocity, keep.velocity).any()


def test_a_reversed_gas_returns(tmp_path, old):
    """Velocities reversed, some events later: each disc is back where it was then, to what chaos makes of rounding."""
    with open_log(old) as log:
        before, after = log.end_time - 0.1, log.end_time
        expected = log.state_at(before)
    with logged(parse_scene(f"{GAS}[start]\nlog = '{old}'\nvelocities = 'reversed'\n"), tmp_path / "new.h5") as log:
        result = log.state_at(after - before)
    assert np.abs(result.position - expected.position).max() < 1e-11
    assert np.abs(result.velocity + expected.velocity).max() < 1e-11


def test_methods_agree_from_a_start(tmp_path, old):
    for method in ("event_driven", "brute_force"):
        simulate(parse_scene(f"{GAS}[start]\nlog = '{old}'\n", overrides=[f"run.method={method}"]), tmp_path / method)
    assert set(differences(tmp_path / "event_driven", tmp_path / "brute_force")) <= {"scene"}


@pytest.mark.parametrize("kind", ["csv", "gsd", "extxyz", "npz"])
def test_exported_frames_are_starts(tmp_path, old, kind):
    path = tmp_path / f"frames.{kind}"
    with open_log(old) as log:
        discs, state = log.discs, log.state_at(log.end_time)
    if kind == "npz":
        names = np.array(discs.species_names)[discs.species]
        np.savez(path, position=state.position, velocity=state.velocity, species=names)
    else:
        output_of("export", old, "--format", kind, "--frames", 5, "-o", path)
    (tmp_path / "next.toml").write_text(f'{GAS}[start]\nfile = "{path.name}"\n')
    scene = load_scene(tmp_path / "next.toml")
    given = scene.explicit_discs
    exact = 2e-6 if kind == "gsd" else 0  # single precision
    assert np.abs(given.position - state.position).max() <= exact
    assert np.abs(given.velocity - state.velocity).max() <= exact
    assert (scene.start.overlap > 0) == (kind == "gsd")
    assert given.names == ("light", "heavy")
    assert np.array_equal(given.radius, discs.radius)
    simulate(scene, tmp_path / "new.h5")


def test_a_species_without_a_table_has_its_radius_from_the_log_and_more_discs_are_placed(tmp_path, old):
    scene = parse_scene(f"box.size = [8.0, 6.0]\nrun.events = 100\n[start]\nlog = '{old}'\n")
    assert scene.explicit_discs.names == ("light", "heavy")
    with logged(scene, tmp_path / "new.h5") as log:
        assert log.discs.radius.tolist() == [0.2] * 30 + [0.4] * 10
    scene = parse_scene(f"{GAS}[start]\nlog = '{old}'\n", overrides=["species.light.count=35"])
    with logged(scene, tmp_path / "more.h5") as log:
        assert log.scene == scene
        assert np.bincount(log.discs.species).tolist() == [35, 10]
        assert np.array_equal(log.discs.position[:40], scene.explicit_discs.position)
    resume(tmp_path / "more.h5", ["run.events=4100"])


START = f"{GAS}[start]\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (START, "start.log: exactly one source of discs is required (got nothing; allowed either log or file)"),
        (
            START + "log = 'a.h5'\nfile = 'b.csv'\n",
            "start.log: exactly one source of discs is required (got log and file",
        ),
        (START + "log = 'none.h5'\n", "start.log: cannot be started from (got"),
        (START + "file = 'none.csv'\n", "start.file: cannot be read (got "),
        (START + "file = 'none.txt'\n", "start.file: unknown kind of file (got none.txt; allowed .npz, .csv"),
        (START + "log = 'OLD'\ntime = 1e9\n", "start.log: cannot be started from (got OLD: no state at time 1e+09"),
        (START + "log = 'OLD'\ntime = 'soon'\n", "start.time: unknown value"),
        (START + "log = 'OLD'\nvelocities = 'old'\n", "start.velocities: unknown value"),
        (
            START + "log = 'OLD'\n[[disc]]\nposition = [1, 1]\nradius = 0.1\n",
            "disc.0: [[disc]] tables in addition to [start]",
        ),
        ("box.size=[8, 6]\nrun.events=1\n[start]\nlog = 'OLD'\nvelocities = 'new'\n", "no species for new velocities"),
        (
            START.replace("count = 30", "count = 29") + "log = 'OLD'\n",
            "species.light.count: fewer discs than are given",
        ),
        (START.replace("[8.0, 6.0]", "[7.0, 6.0]") + "log = 'OLD'\n", "not in the box"),
        (
            START.replace("radius = 0.2", "radius = 0.5") + "log = 'OLD'\n",
            "start.log: column radius, disc 0: differs from its species "
            '(got 0.2; allowed 0.5, the value of species "light")',
        ),
        (
            START.replace("mass = 5", "mass = 6") + "log = 'OLD'\n",
            "start.log: column mass, disc 30: differs from its species "
            '(got 5.0; allowed 6.0, the value of species "heavy")',
        ),
    ],
)
def test_faults_are_lines(tmp_path, old, text, message):
    (tmp_path / "next.toml").write_text(text.replace("OLD", str(old)))
    done = called("check", tmp_path / "next.toml")
    assert (done.returncode, done.stdout) == (2, "")
    assert message.replace("OLD", str(old)) in done.stderr


def test_a_scene_from_python(tmp_path):
    position = np.array([[1.0, 1.0], [3.0, 1.0], [5.0, 1.0]])
    species = [{"name": "heavy", "count": 5, "radius": 0.4, "mass": 3.0, "temperature": 1.0}]
    discs = {"position": position, "velocity": -position, "radius": [0.3, 0.4, 0.3], "species": ["a", "heavy", "a"]}
    scene = Scene(box={"size": (8.0, 6.0)}, run={"events": 1000}, species=species, discs=discs)
    with logged(scene, tmp_path / "new.h5") as log:
        assert log.scene == scene
        assert log.discs.species_names == ("a", "heavy")
        assert log.discs.radius.tolist() == [0.3, 0.4, 0.3, *[0.4] * 4]
        assert np.array_equal(log.discs.position[:3], position)
    resume(tmp_path / "new.h5", ["run.events=1200"])


@pytest.mark.parametrize(
    ("discs", "message"),
    [
        ({"velocity": [[1, 1]]}, "start.discs: no position column"),
        ({"position": [[1, 1]], "radii": [1]}, "start.discs: unknown column (got radii"),
        (
            {"position": [1, 1, 1], "radius": 1},
            "start.discs: column position has the wrong shape (got (3,); allowed (n, 2))",
        ),
        (
            {"position": [[1, 1]], "radius": [1, 2]},
            "start.discs: column radius has the wrong length (got 2 rows; allowed 1",
        ),
        ({"position": [["a", 1]], "radius": [1]}, "start.discs: column position is not numeric"),
        ({"position": [[1, 1]]}, "start.discs: column radius, disc 0: invalid number (got nan"),
        ({"position": [[1, 1], [2, 1]], "radius": 1}, "start: disc 1 overlaps disc 0"),
        ({"position": [[1, 1]], "radius": 1, "species": [1]}, "start.discs: column species does not contain names"),
        ({"position": np.empty((0, 2)), "radius": 1}, "start.discs: no discs"),
    ],
)
def test_errors_from_python_are_scene_errors(discs, message):
    with pytest.raises(SceneError) as caught:
        Scene(box={"size": (8.0, 6.0)}, run={"events": 1000}, discs=discs)
    assert caught.value.errors[0].startswith(message)


def test_wrong_tables_from_python_are_scene_errors():
    with pytest.raises(SceneError, match=r"box.size: missing .*\nrun: missing"):
        Scene(box={}, species=[{"name": "a", "count": 1, "radius": 1, "temperature": 1}])
    with pytest.raises(SceneError, match="magic: unknown table"):
        Scene(magic=1)


def test_many_given_discs_start_where_they_are(tmp_path):
    """10⁵ discs from a file of arrays."""
    n, rng = 317, np.random.default_rng(1)
    position = np.stack(np.meshgrid(np.arange(n), np.arange(n)), -1).reshape(-1, 2) + 0.5
    np.savez(
        tmp_path / "many.npz", position=position, velocity=rng.normal(size=position.shape), radius=np.full(n * n, 0.3)
    )
    (tmp_path / "many.toml").write_text(f"box.size = [{n}, {n}]\nrun.events = 10\n[start]\nfile = 'many.npz'\n")
    summary = simulate(load_scene(tmp_path / "many.toml"), tmp_path / "many.h5")
    assert summary.events == 10
    with open_log(tmp_path / "many.h5") as log:
        assert np.array_equal(log.discs.position, position)


def test_a_scene_of_a_log_with_explicit_discs_names_their_species(tmp_path):
    text = "box.size = [8, 6]\nrun.events = 500\n" + "".join(
        f"[[disc]]\nposition = [{2 * k + 1}, {k + 1}]\nvelocity = [1, {k}]\n"
        f'radius = 0.{k + 1}\nspecies = "{"ab"[k % 2]}"\n'
        for k in range(4)
    )
    simulate(parse_scene(text), tmp_path / "old.h5")
    output_of("scene", tmp_path / "old.h5", "-o", tmp_path / "next.toml")
    scene = load_scene(tmp_path / "next.toml")
    assert scene.explicit_discs.names == ("a", "b")
    assert scene.explicit_discs.radius.tolist() == [0.1, 0.2, 0.3, 0.4]
    assert dump_document(scene).count("[[disc]]") == 0
    assert json.loads(called("check", tmp_path / "next.toml", "--json").stdout)["scene"]["start"]["number"] == 4
