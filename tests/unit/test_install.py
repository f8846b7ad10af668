"""What an installation puts on a machine: the packages `idealgas` and `idealgas_cli`, all of them, and nothing else."""

import os
import shutil
import subprocess
import sys
import tarfile
import venv
from pathlib import Path
from zipfile import ZipFile

import pytest
from helpers.support import ROOT

import idealgas

BUILD = "import sys; from setuptools import build_meta; getattr(build_meta, sys.argv[1])(sys.argv[2])"
LOOK = """
import importlib.util, site, sys
site.addsitedir(sys.argv[1])
import idealgas, idealgas_cli
assert importlib.util.find_spec("cli") is None
assert importlib.util.find_spec("configs") is None
print(idealgas.__file__, idealgas_cli.__file__, sep="\\n")
"""

SCRIPT = """from idealgas import LogState, Summary, analyse, load_scene, open_log, resume, simulate
import idealgas

scene = load_scene("scene.toml", ["run.until=2"])
summary: Summary = simulate(scene, "run.h5", force=True)
print(summary.events, resume("run.h5", ["run.until=3"]).as_dict()["end_time"])
with open_log("run.h5") as log:
    state: LogState = log.state_at(1.5)
    print(state.position.mean(), [len(hits.time) for hits in log.events(disc=0)])
    for route in idealgas.pressure(log, start=0.5).routes:
        print(route.name, route.compressibility_factor.value, route.compressibility_factor.interval(0.9)[0])
    print(analyse(log, "temperature").as_dict()["expected"], idealgas.heat_capacity(log).number)
"""
"""What a user writes."""

WRONG = {
    'load_scene("scene.toml"': "load_scene(1",
    "summary.events": "summary.event",
    "idealgas.pressure(log, start=0.5)": "idealgas.presure(log)",
    "compressibility_factor.value": "compressibility_factor.val",
    "state.position": "state.positions",
    "start=0.5": "start='early'",
}
"""Slips of the pen that a type checker finds."""

SCENE = """
box.size = [5, 5]
species = [{ name = "gas", count = 30, radius = 0.1, temperature = 1.0 }]
run.until = 1
"""


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """A copy of what is packaged, so that building leaves no trace in the tree."""
    folder = tmp_path_factory.mktemp("source")
    for name in ("idealgas", "cli", "configs", "tests"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, folder)
    return folder


def build(source, kind, folder):
    """Names in the wheel, which is unpacked into the folder, and the lines of its entry points."""
    made = subprocess.run([sys.executable, "-c", BUILD, kind, str(folder)], cwd=source, capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    (wheel,) = folder.glob("*.whl")
    with ZipFile(wheel) as archive:
        archive.extractall(folder)
        names = archive.namelist()
        (entry_points,) = (name for name in names if name.endswith("entry_points.txt"))
        return names, archive.read(entry_points).decode().split("\n")


def found_in(folder):
    """Where a Python that knows nothing else finds the two packages."""
    looked = subprocess.run(
        [sys.executable, "-I", "-S", "-c", LOOK, str(folder)], cwd=folder, capture_output=True, text=True
    )
    assert (looked.returncode, looked.stderr) == (0, "")
    return looked.stdout.splitlines()


@pytest.fixture(scope="module")
def fresh(source, tmp_path_factory):
    """The folder of an environment into which `pip install .` has put the project; what it needs is lent to it."""
    folder = tmp_path_factory.mktemp("fresh")
    venv.create(folder, with_pip=False, symlinks=True)
    (packages,) = folder.glob("lib/python*/site-packages")
    lent = [path for path in sys.path if Path(path).name in ("site-packages", "dist-packages")]
    (packages / "lent.pth").write_text("\n".join(lent))
    python = Path(sys.base_prefix, "bin", f"python{sys.version_info[0]}.{sys.version_info[1]}")  # which has pip
    pip = [str(python), "-m", "pip", "--disable-pip-version-check", "--python", str(folder / "bin" / "python")]
    quiet = ["install", "-q", "--no-deps", "--no-build-isolation", "--root-user-action=ignore"]
    done = subprocess.run([*pip, *quiet, str(source)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder


def output(folder, *command, code=0):
    """What a command prints, run in a folder, where no other copy of the project is to be found."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (code, "")
    return done.stdout


@pytest.mark.slow
def test_install(fresh, tmp_path):
    """The interface, the licence and the marker of types are there, and a user's script runs."""
    (packages,) = fresh.glob("lib/python*/site-packages")
    assert (packages / "idealgas" / "py.typed").is_file()
    (licence,) = packages.glob("idealgas_md-*.dist-info/licenses/**/LICENSE")
    assert "MIT" in licence.read_text(encoding="utf-8")
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "script.py").write_text(SCRIPT)
    python = str(fresh / "bin" / "python")
    assert Path(output(tmp_path, python, "-c", "print(__import__('idealgas').__file__)").strip()).is_relative_to(fresh)
    assert "pairs, virial" in output(tmp_path, python, "-W", "error", "script.py")
    for command in ([str(fresh / "bin" / "idealgas")], [python, "-m", "idealgas"]):
        assert output(tmp_path, *command, "--version") == f"idealgas, version {idealgas.__version__}\n"


@pytest.mark.slow
def test_types_for_users(fresh, tmp_path):
    """mypy in strict mode takes a user's script, and finds what is wrong in others."""
    names = ["script.py", *(f"wrong{k}.py" for k in range(len(WRONG)))]
    texts = [SCRIPT, *(SCRIPT.replace(right, wrong, 1) for right, wrong in WRONG.items())]
    for name, text in zip(names, texts, strict=True):
        (tmp_path / name).write_text(text)
    mypy = [sys.executable, "-m", "mypy", "--strict", "--python-executable", str(fresh / "bin" / "python")]
    printed = output(tmp_path, *mypy, "--cache-dir", os.devnull, *names, code=1)
    errors = [line.partition(":")[0] for line in printed.splitlines() if ": error: " in line]
    assert sorted(errors) == names[1:], printed


def test_wheel(source, tmp_path):
    names, entry_points = build(source, "build_wheel", tmp_path)
    code = {name for name in names if ".dist-info/" not in name}
    expected = {
        f"idealgas/{p.relative_to(ROOT / 'idealgas').as_posix()}"
        for p in (ROOT / "idealgas").rglob("*")
        if p.is_file() and p.suffix not in (".pyc", ".md")
    }
    scenes = [path for kind in ("toml", "json", "csv", "ipynb") for path in (ROOT / "configs").rglob(f"*.{kind}")]
    expected |= {f"idealgas_scenes/{path.relative_to(ROOT / 'configs').as_posix()}" for path in scenes}
    expected |= {f"idealgas_cli/{p.name}" for p in (ROOT / "cli").glob("*.py")}
    assert code == expected
    assert "idealgas = idealgas_cli.main:main" in entry_points
    assert found_in(tmp_path) == [str(tmp_path / name / "__init__.py") for name in ("idealgas", "idealgas_cli")]


@pytest.mark.slow
def test_editable(source, tmp_path):
    _, entry_points = build(source, "build_editable", tmp_path)
    assert "idealgas = idealgas_cli.main:main" in entry_points
    assert found_in(tmp_path) == [str(source / name / "__init__.py") for name in ("idealgas", "cli")]


@pytest.mark.needs("a clone")
def test_a_source_distribution_has_all_files_under_version_control(tmp_path):
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    source = tmp_path / "source"
    for name in listed.stdout.splitlines():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, source / name)
    commit = ["git", "-c", "user.name=a", "-c", "user.email=a@b", "commit", "-qm", "all"]
    for command in (["git", "init", "-q"], ["git", "add", "-A"], commit):
        subprocess.run(command, cwd=source, check=True)
    command = [sys.executable, "-W", "ignore", "-c", BUILD, "build_sdist", str(tmp_path)]
    made = subprocess.run(command, cwd=source, capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    (packed,) = tmp_path.glob("idealgas_md-*.tar.gz")
    with tarfile.open(packed) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert set(listed.stdout.splitlines()) <= names
