"""Machine code: its cache, one folder for each state of the sources, and what asks for memory ahead."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support import ROOT

FOLDER = "from idealgas._jit import cache_folder; print(cache_folder())"
MODULE = """
from idealgas._jit import njit

@njit
def twice(x):
    return 2 * x
"""
COMPILED = """
from module import twice
assert twice(21) == 42
print(sum(twice.stats.cache_hits.values()), sum(twice.stats.cache_misses.values()))
"""

NEAR = """
from idealgas._jit import fetch_next_line, njit

@njit
def near(column, row):
    fetch_next_line(column, row)
"""
NEAR_THE_END = """
import numpy as np
from idealgas._jit import fetch_next_line
from module import near
for column in (np.arange(3.0), np.ones((3, 2)), np.zeros(3, np.uint8)):
    before = column.copy()
    assert fetch_next_line(column, 2) is None and near(column, np.uintp(2)) is None
    assert (column == before).all()
print(*(code.count("call void @llvm.prefetch") for code in near.inspect_llvm().values()))
"""


def python(program, folder, **environment):
    """What a program prints in a fresh Python that finds the package in a folder first."""
    environment = {"NUMBA_DISABLE_JIT": "0", "PATH": "/usr/bin:/bin", **environment}
    done = subprocess.run([sys.executable, "-c", program], cwd=folder, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.strip()


@pytest.fixture
def copy(tmp_path):
    """A folder with a copy of the package."""
    shutil.copytree(ROOT / "idealgas", tmp_path / "copy" / "idealgas", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "copy"


def test_every_change_of_a_source_is_another_folder(copy, tmp_path):
    """A change anywhere in the package, as numba looks at a function's own file only."""
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    seen = [python(FOLDER, copy, **cache)]
    assert Path(seen[0]).parent == tmp_path / "cache"
    assert python(FOLDER, copy, **cache) == seen[0]
    for name in ("physics/motion.py", "scene/model.py"):
        with (copy / "idealgas" / name).open("a") as source:
            source.write("# changed\n")
        seen.append(python(FOLDER, copy, **cache))
    (copy / "idealgas" / "more.py").touch()
    seen.append(python(FOLDER, copy, **cache))
    assert len(set(seen)) == 4


def test_the_same_sources_elsewhere_share_a_folder(copy, tmp_path):
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert python(FOLDER, copy, **cache) == python(FOLDER, ROOT, **cache)


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"NUMBA_CACHE_DIR": "{}/one", "XDG_CACHE_HOME": "{}/two", "HOME": "{}/three"}, "one"),
        ({"XDG_CACHE_HOME": "{}/two", "HOME": "{}/three"}, "two/idealgas"),
        ({"HOME": "{}/three"}, "three/.cache/idealgas"),
    ],
)
def test_where_the_cache_is(variables, expected, tmp_path):
    variables = {name: value.format(tmp_path) for name, value in variables.items()}
    folder = Path(python(FOLDER, ROOT, **variables))
    assert folder.is_dir()
    assert folder.parent == tmp_path / expected


def test_a_temporary_folder_when_there_can_be_no_cache(copy, tmp_path):
    """A file is in the way, which stops root as well."""
    (tmp_path / "file").touch()
    (tmp_path / "temporary").mkdir()
    (copy / "module.py").write_text(MODULE)
    variables = {"NUMBA_CACHE_DIR": str(tmp_path / "file"), "TMPDIR": str(tmp_path / "temporary")}
    folder = Path(python(FOLDER, copy, **variables))
    assert folder.parent == tmp_path / "temporary"
    assert python(COMPILED, copy, **variables) == "0 1"


def test_a_second_process_compiles_nothing(copy, tmp_path):
    (copy / "module.py").write_text(MODULE)
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert python(COMPILED, copy, **cache) == "0 1"
    assert python(COMPILED, copy, **cache) == "1 0"
    with (copy / "idealgas" / "physics" / "motion.py").open("a") as source:
        source.write("# changed\n")
    assert python(COMPILED, copy, **cache) == "0 1"


def test_memory_behind_an_array_is_asked_for_and_left_alone(copy, tmp_path):
    """Its last row has no line behind it; in Python nothing is asked for."""
    (copy / "module.py").write_text(NEAR)
    assert python(NEAR_THE_END, copy, NUMBA_CACHE_DIR=str(tmp_path / "cache")) == "1 1 1"
