"""What an installation puts on a machine: the packages `idealgas` and `idealgas_cli`, all of them, and nothing else."""

import shutil
import subprocess
import sys
from zipfile import ZipFile

import pytest
from support import ROOT

BUILD = "import sys; from setuptools import build_meta; getattr(build_meta, sys.argv[1])(sys.argv[2])"
LOOK = """
import importlib.util, site, sys
site.addsitedir(sys.argv[1])
import idealgas, idealgas_cli
assert importlib.util.find_spec("cli") is None
assert importlib.util.find_spec("configs") is None
print(idealgas.__file__, idealgas_cli.__file__, sep="\\n")
"""


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """A copy of what is packaged, so that building leaves no trace in the tree."""
    folder = tmp_path_factory.mktemp("source")
    for name in ("idealgas", "cli", "configs", "tests", ".packages"):
        shutil.copytree(ROOT / name, folder / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
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


def test_wheel(source, tmp_path):
    names, entry_points = build(source, "build_wheel", tmp_path)
    code = {name for name in names if ".dist-info/" not in name}
    expected = {
        f"idealgas/{p.relative_to(ROOT / 'idealgas').as_posix()}"
        for p in (ROOT / "idealgas").rglob("*.*")
        if p.suffix != ".pyc"
    }
    expected |= {f"idealgas_cli/{p.name}" for p in (ROOT / "cli").glob("*.py")}
    assert code == expected
    assert "idealgas = idealgas_cli.main:main" in entry_points
    assert found_in(tmp_path) == [str(tmp_path / name / "__init__.py") for name in ("idealgas", "idealgas_cli")]


def test_editable(source, tmp_path):
    _, entry_points = build(source, "build_editable", tmp_path)
    assert "idealgas = idealgas_cli.main:main" in entry_points
    assert found_in(tmp_path) == [str(source / name / "__init__.py") for name in ("idealgas", "cli")]
