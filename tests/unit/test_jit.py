"""The cache of machine code, which belongs to the sources that it is made from."""

from pathlib import Path

import pytest
from fresh_python import python, start

pytestmark = pytest.mark.slow

PACKAGE = {
    "__init__": "",
    "entry": """
from typing import TYPE_CHECKING
from idealgas.jit import njit
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
from idealgas.jit import inline

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

FOLDER = "from idealgas.jit import cache_folder; from toy.entry import entry; print(cache_folder(entry))"
COMPILED = """
from toy.entry import entry
print(entry(20), sum(entry.stats.cache_hits.values()), sum(entry.stats.cache_misses.values()))
"""
INTERPRETED = {"NUMBA_DISABLE_JIT": "1"}


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


def test_a_folder_belongs_to_a_module_and_what_it_imports(toy, cache):
    """Anywhere in it and from anywhere, but not for type checkers, nor what is beside that."""
    last = python(FOLDER, toy, **cache, **INTERPRETED)
    assert Path(last).parent == Path(cache["NUMBA_CACHE_DIR"], "toy.entry")
    assert python(FOLDER, toy, **cache, **INTERPRETED) == last
    same = set()
    for module in PACKAGE:
        change(toy / "toy" / f"{module}.py")
        folder = python(FOLDER, toy, **cache, **INTERPRETED)
        if folder == last:
            same.add(module)
        last = folder
    assert same == {"__init__", "apart", "hints", "laws/quadratic"}


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


def test_of_each_module_the_three_folders_last_used_stay(toy, cache, tmp_path):
    """And all that has another name than theirs."""
    base = tmp_path / "cache"
    strangers = [base / "0123456789abcdef", base / "toy.entry" / "mine", base / "toy.entry" / "0123456789abcdef.txt"]
    for stranger in strangers:
        stranger.mkdir(parents=True)
    (base / "toy.entry" / "fedcba9876543210").symlink_to(tmp_path)
    folders = []
    for version in (0, 1, 2, 0, 3, 4):
        (toy / "toy" / "constants.py").write_text(f"ONE = {version}")
        folders.append(Path(python(FOLDER, toy, **cache, **INTERPRETED)))
    assert [folder.exists() for folder in folders] == [True, False, False, True, True, True]
    assert all(stranger.is_dir() for stranger in strangers)
    assert len(list((base / "toy.entry").iterdir())) == 3 + 3


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"NUMBA_CACHE_DIR": "{}/one", "XDG_CACHE_HOME": "{}/two", "HOME": "{}/three"}, "one"),
        ({"XDG_CACHE_HOME": "{}/two", "HOME": "{}/three"}, "two/idealgas"),
        ({"HOME": "{}/three"}, "three/.cache/idealgas"),
    ],
)
def test_where_the_cache_is(toy, variables, expected, tmp_path):
    variables = {name: value.format(tmp_path) for name, value in variables.items()}
    folder = Path(python(FOLDER, toy, **variables))
    assert folder.is_dir()
    assert folder.parent.parent == tmp_path / expected


DAMAGE = """
import os, sys
from pathlib import Path
from idealgas.jit import cache_folder, njit
from toy.entry import entry

def state(argument=20):
    again = njit(entry.py_func)
    assert again(argument) == 2 * argument + 1
    return sum(again.stats.cache_hits.values())

def file(suffix):
    [path] = cache_folder(entry).glob(f"*{suffix}")
    return path

assert (state(), state()) == (0, 1)
code = file(".nbc").read_bytes()
seen = []
for suffix in (".nbi", ".nbc"):
    whole = file(suffix).read_bytes()
    shorter = [whole[:size] for size in (0, 1, len(whole) // 2, len(whole) - 1)]
    for damaged in (*shorter, os.urandom(len(whole)), b"N.", b"K\\1K\\2\\x86."):
        file(suffix).write_bytes(damaged)
        seen.append((state(), state()))
for place in (len(code) // 4, len(code) // 2, len(code) * 3 // 4):  # still unpickled, but not what was saved
    file(".nbc").write_bytes(code[:place] + bytes([code[place] ^ 1]) + code[place + 1 :])
    seen.append((state(), state()))
file(".nbc").unlink()
seen.append((state(), state()))
file(".nbi").unlink()
assert (state(0.5), state(0.5)) == (0, 1)
file(".nbc").write_bytes(code)  # of another type of argument, as another process that saves at once may leave it
seen.append((state(0.5), state(0.5)))
print(set(seen), len(seen))
"""


def test_a_damaged_file_is_written_anew(toy, cache):
    assert python(DAMAGE, toy, **cache) == "{(0, 1)} 19"


def test_what_cannot_be_saved_is_compiled_each_time(toy, cache):
    """A file is in the way, which stops root as well."""
    folder = Path(python(FOLDER, toy, **cache))
    folder.rmdir()
    folder.touch()
    assert python(COMPILED, toy, **cache) == python(COMPILED, toy, **cache) == "41 0 1"


def test_first_runs_at_once(toy, cache):
    """With the same types of arguments and with others."""
    programs = [COMPILED, COMPILED.replace("20", "20.0")] * 2
    processes = [start(program, toy, **cache) for program in programs]
    done = [(*process.communicate(), process.returncode) for process in processes]
    assert [(output.split()[0], errors, code) for output, errors, code in done] == [("41", "", 0), ("41.0", "", 0)] * 2
    last = [python(programs[kind], toy, **cache) for kind in (0, 1, 1)]  # what lost its place to the other is saved now
    assert last[-1] == "41.0 1 0"


TUPLES = """
from typing import NamedTuple

class Sides(NamedTuple):
    {}: float
    {}: float
"""
FIELD = """
from idealgas.jit import njit

@njit
def left(sides):
    return sides.left
"""


def test_the_fields_of_a_named_tuple_are_part_of_the_key(tmp_path, cache):
    """Its class need not be imported where it is used."""
    (tmp_path / "field.py").write_text(FIELD)
    program = "from field import left; from tuples import Sides; print(left(Sides(1.0, 2.0)))"
    for names, expected in ((("left", "right"), "1.0"), (("right", "left"), "2.0")):
        (tmp_path / "tuples.py").write_text(TUPLES.format(*names))
        assert python(program, tmp_path, **cache) == expected


TEMPORARY = """
import multiprocessing, os, sys
from idealgas.jit import cache_folder
from toy.entry import entry

if __name__ == "__main__":
    folder = cache_folder(entry)
    assert entry(20) == 41 and list(folder.glob("*.nbc"))
    if os.fork() == 0:
        sys.exit(0)
    assert os.wait()[1] == 0
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        other = pool.apply(cache_folder, [entry])
        pool.close()
        pool.join()
    assert list(folder.glob("*.nbc")) and other != folder and not other.exists()
    print(folder)
"""


def test_a_temporary_folder_when_there_can_be_no_cache(toy, tmp_path):
    """Removed at the end of the process that made it, not of its children."""
    (tmp_path / "file").touch()
    (tmp_path / "temporary").mkdir()
    variables = {"NUMBA_CACHE_DIR": str(tmp_path / "file"), "TMPDIR": str(tmp_path / "temporary")}
    folder = Path(python(TEMPORARY, toy, **variables))
    assert folder.is_relative_to(tmp_path / "temporary")
    assert not list((tmp_path / "temporary").iterdir())


def test_what_has_no_source_file_is_compiled_but_not_cached(tmp_path, cache):
    program = FIELD.replace("sides.left", "sides") + "print(left(3), *left.stats.cache_hits)"
    assert python(program, tmp_path, **cache) == "3"
    assert not list(tmp_path.iterdir())


SUMS = """
from idealgas.jit import njit

@njit
def total(column):
    found = 0.0
    for k in range(column.shape[0]):
        found += column[k]
    return found

@njit
def largest(column):
    found = column[0]
    for k in range(column.shape[0]):
        found = max(found, column[k])
    return found
"""
ONE_LOADED_ONE_COMPILED = """
import sys
import numpy as np
from module import largest, total
column = np.array([1.0, 4.0, 2.0])
print(total(column), "numba.np.arraymath" in sys.modules, end=" ")
if BOTH:
    print(largest(column), "numba.np.arraymath" in sys.modules, end=" ")
print(sum(total.stats.cache_hits.values()), sum(largest.stats.cache_hits.values()))
"""


def test_what_only_compiling_needs_is_not_brought_to_load_machine_code(tmp_path, cache):
    """After that, another function of the same process can still be compiled, and next time both are loaded."""
    (tmp_path / "module.py").write_text(SUMS)
    one, both = (f"BOTH = {both}{ONE_LOADED_ONE_COMPILED}" for both in (False, True))
    assert python(one, tmp_path, **cache) == "7.0 True 0 0"
    assert python(one, tmp_path, **cache) == "7.0 False 1 0"
    assert python(both, tmp_path, **cache) == "7.0 False 4.0 True 1 0"
    assert python(both, tmp_path, **cache) == "7.0 False 4.0 False 1 1"
