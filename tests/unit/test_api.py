"""The Python interface: its names, what they import and when, and that results are plain values."""

import dataclasses
import json
import lzma
import shutil
import subprocess
import sys
from contextlib import nullcontext

import pytest
from helpers.support import ROOT, uncompiled
from helpers.write_stub import STUB, stub

import idealgas
from idealgas.analysis import registry

HEAVY = {"numpy", "numba", "h5py", "scipy", "pydantic", "matplotlib", "pandas", "rich", "click"}
LOGS = ROOT / "tests" / "cases" / "logs"
PACKED = ".h5.xz"
TYPES = (
    "Estimate", "EventBatch", "Kind", "Log", "LogError", "LogState", "OutputError", "Progress", "Scene", "SceneError",
    "Summary",
)  # fmt: skip
FUNCTIONS = (
    "load_scene", "parse_scene", "simulate", "resume", "open_log", "open_run", "analyse", "animate", "combine",
    "export", "load_example", "load_sweep", "run_sweep", "sensitivity", "study_accuracy", "write_report",
)  # fmt: skip

SCENES = {
    "waves": """
        box = {size = [8, 8], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic"}
        species = [{name = "gas", count = 30, radius = 0.5, temperature = 1}]
        run.collisions_per_disc = 1500
    """,  # for long enough to measure its sound
    "grains": """
        box.size = [8, 8]
        species = [{ name = "grains", count = 30, radius = 0.2, speed = 1.0 }]
        restitution.normal = 0.95
        run.collisions_per_disc = 40
    """,
    "gate": """
        box.size = [12, 8]
        species = [{ name = "gas", count = 40, radius = 0.05, temperature = 1, region = [0, 0, 4, 8] }]
        wall = [
            { from = [4, 0], to = [4, 3] },
            { from = [4, 3], to = [4, 5], opens_at = 1.0 },
            { from = [4, 5], to = [4, 8] },
        ]
        run.until = 20
    """,
    "strokes": """
        box.size = [8, 8]
        thermostat = { temperature = 1, rate = 1 }
        piston = [{ side = "right", velocity = [[0, 0], [5, -1], [6, 0], [11, 1], [12, 0], [17, -1], [18, 0]] }]
        species = [{ name = "gas", count = 2, radius = 0.2, temperature = 1 }]
        run.until = 20
    """,
    "sheared": """
        box = { size = [8, 8], left = "periodic", right = "periodic", bottom.shear = 0.2, top.shear = 0.2 }
        species = [{ name = "gas", count = 30, radius = 0.3, temperature = 1 }]
        run.collisions_per_disc = 40
    """,
    "hole": """
        box.size = [8, 8]
        wall = [{ from = [4, 0], to = [4, 2], absorbing = true }]
        species = [{ name = "gas", count = 30, radius = 0.1, temperature = 1 }]
        run.until = 20
    """,
}


def python(code, *arguments, folder=None):
    """What a Python of its own prints."""
    done = subprocess.run([sys.executable, "-c", code, *arguments], cwd=folder, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """Paths of logs by name: of each kind, with waves, cooling, a gate, strokes of a piston, shear, and a hole."""
    folder = tmp_path_factory.mktemp("logs")
    for packed in LOGS.glob(f"*{PACKED}"):
        name = packed.name.removesuffix(".xz").partition("-")[2]  # without the version of the format
        (folder / name).write_bytes(lzma.decompress(packed.read_bytes()))
    for name, text in SCENES.items():
        with uncompiled() if name == "strokes" else nullcontext():  # of few events, with effects of its own
            idealgas.simulate(idealgas.parse_scene(text), folder / f"{name}.h5")
    return {path.stem: path for path in sorted(folder.glob("*.h5"))}


# ── names ──


def test_linear_algebra_takes_one_thread_unless_another_number_is_set():
    name = "OPENBLAS_NUM_THREADS"
    show = f"import idealgas, sys; print(os.environ['{name}'], 'numpy' in sys.modules)"
    assert python(f"import os; os.environ.pop('{name}', None); {show}") == "1 False\n"
    assert python(f"import os; os.environ['{name}'] = '3'; {show}") == "3 False\n"


def test_dir_shows_every_name():
    assert dir(idealgas) == sorted({*idealgas.__all__, *registry.names()})
    functions = {*FUNCTIONS, *registry.names()}
    assert set(dir(idealgas)) == functions | {*TYPES, "UserError", "__version__"}
    assert all(callable(getattr(idealgas, name)) and getattr(idealgas, name).__doc__ for name in functions)
    assert all(isinstance(getattr(idealgas, name), type) for name in TYPES)


def test_type_checkers_see_every_name():
    """The stub is made from the names; `PYTHONPATH=tests python -m helpers.write_stub` writes it again."""
    assert STUB.read_text(encoding="utf-8") == stub()


def test_unknown_names_and_the_same_function_at_each_use():
    with pytest.raises(AttributeError, match=r"^module 'idealgas' has no attribute 'presure'$"):
        idealgas.presure  # noqa: B018
    with pytest.raises(ImportError, match="presure"):
        exec("from idealgas import presure")
    assert idealgas.pressure is idealgas.pressure


def test_nothing_heavy_is_imported_before_it_is_used():
    code = "import sys, idealgas; dir(idealgas), idealgas.UserError; print(*{m.split('.')[0] for m in sys.modules})"
    assert not HEAVY & set(python(code).split())


def test_no_module_shadows_a_name():
    """Whatever has been imported before."""
    code = """if True:
        import importlib, pkgutil, types, idealgas
        for module in pkgutil.walk_packages(idealgas.__path__, "idealgas."):
            if not module.name.endswith("__main__"):
                importlib.import_module(module.name)
        print(*(name for name in dir(idealgas) if isinstance(getattr(idealgas, name), types.ModuleType)))
        print(idealgas.simulate.__name__, type(idealgas.analysis.pressure).__name__, idealgas.pressure.__name__)
    """
    assert python(code) == "\nsimulate module pressure\n"


# ── scenes, runs and logs ──

SCENE = """
scene.seed = 4
box.size = [6, 4]
species = [{ name = "gas", count = 60, radius = 0.1, temperature = 1.0 }]
run.until = 400
"""


def test_run_resume_and_analyse(tmp_path):
    path, shares = tmp_path / "run.h5", []
    scene = idealgas.parse_scene(SCENE)
    stopped = idealgas.simulate(
        scene, path, on_progress=lambda progress: shares.append(progress.share), interrupted=lambda: True
    )
    assert not stopped.completed
    assert shares
    with pytest.raises(idealgas.OutputError, match="already exists"):
        idealgas.simulate(scene, path)
    idealgas.resume(path)
    summary = idealgas.resume(path, "run.until=500")
    assert (summary.completed, summary.end_time) == (True, 500.0)
    assert idealgas.Summary.of(json.loads(json.dumps(summary.as_dict()))) == summary
    with idealgas.open_log(path) as log:
        assert log.summary == summary.as_dict()
        assert len(log) == summary.rows
        assert idealgas.pressure(log, 50.0).as_dict() == idealgas.analyse(log, "pressure", start=50.0).as_dict()


def test_overrides_as_one_text_or_several():
    assert idealgas.parse_scene(SCENE, overrides="run.until=9").run.until == 9
    scene = idealgas.parse_scene(SCENE, overrides=["run.until=9", "species.gas.count=5"])
    assert (scene.run.until, scene.species[0].count) == (9, 5)


def test_errors_of_the_user_are_lines(logs):
    with pytest.raises(idealgas.SceneError) as found:
        idealgas.parse_scene(SCENE.replace("radius", "radus"))
    assert isinstance(found.value, idealgas.UserError)
    assert any("radus" in line for line in found.value.errors)
    with idealgas.open_log(logs["plain"]) as log:
        for call in (
            lambda: idealgas.analyse(log, "presure"),
            lambda: idealgas.histogram(log, "sped"),
            lambda: idealgas.profile(log, along="z"),
            lambda: idealgas.profile(log, bins=0),
            lambda: idealgas.pressure(log, start=-1.0),
        ):
            with pytest.raises(idealgas.UserError) as raised:
                call()
            assert "\n" not in str(raised.value)


def test_functions_of_a_log_take_its_path(logs, tmp_path):
    path = logs["plain"]
    with idealgas.open_log(path) as log:
        expected = idealgas.temperature(log).as_dict()
    assert idealgas.temperature(str(path)).as_dict() == expected
    assert idealgas.analyse(path, "temperature").as_dict() == expected
    assert idealgas.animate(path, tmp_path / "film.gif", end=1.0, fps=2, size=(240, 240)).path.exists()
    assert idealgas.export(path, "extxyz", tmp_path / "gas.extxyz", times=[0.0, 1.0]) == 2
    with pytest.raises(idealgas.LogError, match="cannot be read"):
        idealgas.temperature(tmp_path / "none.h5")


@pytest.mark.parametrize("name", registry.names())
def test_results_are_plain_values(name, logs):
    """Dataclasses whose `as_dict()` JSON takes as it is; those of analyses that have an answer for a log."""
    answered = 0
    for path in logs.values():
        with idealgas.open_log(path) as log:
            try:
                result = getattr(idealgas, name)(log)
            except idealgas.UserError:
                continue
        assert dataclasses.is_dataclass(result)
        assert json.loads(json.dumps(result.as_dict(), allow_nan=False)) == result.as_dict()
        answered += 1
    assert answered


def test_the_example_works(tmp_path):
    shutil.copytree(ROOT / "configs", tmp_path / "configs")
    lines = [line for line in idealgas.__doc__.splitlines() if line.startswith("    ") or not line]
    printed = python("\n".join(line[4:] for line in lines), folder=tmp_path)
    assert "pairs, virial" in printed


def test_the_package_is_the_command():
    run = [sys.executable, "-m", "idealgas"]
    version = subprocess.run([*run, "--version"], capture_output=True, text=True, check=True).stdout
    assert version == f"idealgas, version {idealgas.__version__}\n"
    wrong = subprocess.run([*run, "info", "nowhere.h5"], capture_output=True, text=True)
    assert (wrong.returncode, wrong.stdout, wrong.stderr.count("\n")) == (2, "", 1)
    usage = subprocess.run([*run, "--help"], capture_output=True, text=True, check=True).stdout
    assert usage.startswith("Usage: python -m idealgas ")
