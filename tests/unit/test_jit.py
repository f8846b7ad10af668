"""Machine code: its cache, which belongs to the sources that it is made from, and what asks for memory ahead."""

import ast
import importlib
import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import FunctionType, ModuleType

import pytest
from support import ROOT

from idealgas._jit import compiled_from

PACKAGE = {
    "__init__": "",
    "entry": """
from typing import TYPE_CHECKING
from idealgas._jit import njit
from toy import (  # (a submodule)
    constants,
)
from toy.laws import law

if TYPE_CHECKING:
    from toy.hints import Hint

@njit
def entry(x):
    return law(x) + constants.ONE

def late():
    import toy.later
    from . import relative
""",
    "laws/__init__": "from toy.laws.linear import law",
    "laws/linear": """
from idealgas._jit import inline

@inline
def law(x):
    return 2 * x
""",
    "laws/quadratic": "",
    "constants": "ONE = 1",
    "hints": "",
    "later": "",
    "relative": "",
    "apart": "",
}
"""A package with an entry point, whose law another module passes on."""

FOLDER = "from idealgas._jit import cache_folder; from toy.entry import entry; print(cache_folder(entry))"
COMPILED = """
from toy.entry import entry
print(entry(20), sum(entry.stats.cache_hits.values()), sum(entry.stats.cache_misses.values()))
"""
INTERPRETED = {"NUMBA_DISABLE_JIT": "1"}

MODULES = [
    path.relative_to(ROOT).with_suffix("").as_posix().replace("/", ".")
    for path in sorted((ROOT / "idealgas").rglob("*.py"))
    if "\n@njit" in path.read_text(encoding="utf-8")
]
"""All with entry points."""


def start(program, folder, **environment):
    """A fresh Python that finds the modules of a folder first, then this package."""
    environment = {"NUMBA_DISABLE_JIT": "0", "PATH": "/usr/bin:/bin", "PYTHONPATH": str(ROOT), **environment}
    command = [sys.executable, "-c", program]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(command, cwd=folder, env=environment, text=True, **pipes)


def python(program, folder, **environment):
    """What a program prints in a fresh Python."""
    process = start(program, folder, **environment)
    output, errors = process.communicate()
    assert (process.returncode, errors) == (0, "")
    return output.strip()


def write(folder, name="toy"):
    for module, source in PACKAGE.items():
        path = folder / name / f"{module}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(source)


@pytest.fixture
def toy(tmp_path):
    """A folder with the package."""
    write(tmp_path / "sources")
    return tmp_path / "sources"


@pytest.fixture
def cache(tmp_path):
    """An empty cache."""
    return {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}


def change(path):
    with path.open("a") as source:
        source.write("\n# changed\n")


@pytest.mark.parametrize("module", sorted(PACKAGE))
def test_a_folder_belongs_to_a_module_and_what_it_imports(toy, cache, module):
    """Anywhere in it and from anywhere, but not for type checkers, nor what is beside that."""
    before = python(FOLDER, toy, **cache, **INTERPRETED)
    assert python(FOLDER, toy, **cache, **INTERPRETED) == before
    change(toy / "toy" / f"{module}.py")
    after = python(FOLDER, toy, **cache, **INTERPRETED)
    assert Path(before).parent == Path(after).parent == Path(cache["NUMBA_CACHE_DIR"], "toy.entry")
    assert (after == before) == (module in ("__init__", "apart", "hints", "laws/quadratic"))


def test_a_new_module_in_place_of_a_name_is_another_folder(toy, cache):
    seen = {python(FOLDER, toy, **cache, **INTERPRETED)}
    (toy / "toy" / "laws" / "law.py").touch()
    seen.add(python(FOLDER, toy, **cache, **INTERPRETED))
    assert len(seen) == 2


def test_only_what_is_compiled_from_another_source_is_compiled_again(toy, cache):
    """numba itself looks at a function's own file only."""
    assert python(COMPILED, toy, **cache) == "41 0 1"
    assert python(COMPILED, toy, **cache) == "41 1 0"
    change(toy / "toy" / "apart.py")
    assert python(COMPILED, toy, **cache) == "41 1 0"
    (toy / "toy" / "constants.py").write_text("ONE = 2")
    assert python(COMPILED, toy, **cache) == "42 0 1"


def test_the_same_sources_elsewhere_share_machine_code(toy, cache, tmp_path):
    assert python(COMPILED, toy, **cache) == "41 0 1"
    write(tmp_path / "elsewhere")
    assert python(COMPILED, tmp_path / "elsewhere", **cache) == "41 1 0"


def used(function, seen):
    """Modules of the package whose functions and classes a function uses, in turn; read off the objects themselves."""
    function = getattr(function, "py_func", function)
    if function in seen:
        return
    seen.add(function)
    yield function.__module__
    for name in function.__code__.co_names:
        value = function.__globals__.get(name)
        if isinstance(value, ModuleType):
            yield value.__name__
        elif isinstance(getattr(value, "py_func", value), FunctionType):
            yield from used(value, seen)
        elif isinstance(value, type):
            yield value.__module__


@pytest.mark.parametrize("name", MODULES)
def test_all_that_an_entry_point_uses_determines_its_machine_code(name):
    module = importlib.import_module(name)
    source = ast.parse(Path(module.__file__).read_text(encoding="utf-8"))
    entries = [node.name for node in source.body if isinstance(node, ast.FunctionDef) and node.decorator_list]
    assert entries
    for entry in entries:
        function = getattr(vars(module)[entry], "py_func", vars(module)[entry])
        assert {each for each in used(function, set()) if each.startswith("idealgas")} <= compiled_from(function).keys()
