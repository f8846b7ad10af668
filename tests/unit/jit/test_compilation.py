"""Compilation: machine code on disk, in which folder and until when, and what is used of numba."""

import ast
import inspect
import os
import shutil
from pathlib import Path

import numba
import pytest
from helpers.fresh_python import python, start
from helpers.needs import posix, root
from helpers.support import ROOT

from idealgas.errors import UserError
from idealgas.jit import EntryPoint


def imports(path):
    """Pairs of a module and a name that is imported from it, empty for the module itself."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.module or "", alias.name) for alias in node.names)


DOCUMENTED = {
    "numba",
    "numba.types",
    "numba.typeof",
    "numba.core.compiler.CompilerBase",
    "numba.core.compiler.DefaultPassBuilder",
}
UNDOCUMENTED = {"numba.core.compiler.CompileResult", "numba.core.serialize.dumps"}
"""What `idealgas.jit` uses of numba, and names in its docstring, because there is no other way."""


def test_only_the_interface_of_numba_is_used():
    used = {
        (f"{module}.{name}".removesuffix("."), path.parent.name)
        for folder in ("idealgas", "cli")
        for path in (ROOT / folder).rglob("*.py")
        for module, name in imports(path)
        if module.split(".")[0] == "numba"
    }
    private = {(name, folder) for name, folder in used if not name.startswith("numba.extending.")}
    assert {name for name, folder in private if folder != "jit"} <= {"numba.types"}
    assert {name for name, _ in private} <= DOCUMENTED | UNDOCUMENTED


def test_numba_has_what_it_does_not_document():
    """A new version of numba may change this without notice: then this test names it."""
    from numba.core import caching, compiler, dispatcher, serialize

    def takes(function, *names):
        return tuple(inspect.signature(function).parameters) == names

    compiled = numba.njit(lambda: 0, _nrt=False, no_cfunc_wrapper=True, no_cpython_wrapper=True, forceinline=True)
    is_present = {
        "Dispatcher.compile": takes(dispatcher.Dispatcher.compile, "self", "sig"),
        "Dispatcher._cache": isinstance(compiled._cache, caching.NullCache),
        "load_overload of the cache": takes(caching.Cache.load_overload, "self", "sig", "target_context"),
        "save_overload of the cache": takes(caching.Cache.save_overload, "self", "sig", "data"),
        "CompileResult._reduce": takes(compiler.CompileResult._reduce, "self"),
        "CompileResult._rebuild": hasattr(compiler.CompileResult, "_rebuild"),
        "Dispatcher.overloads": hasattr(compiled.overloads, "items"),
        "serialize.dumps": takes(serialize.dumps, "obj"),
    }
    changed = [name for name, unchanged in is_present.items() if not unchanged]
    assert not changed, f"numba {numba.__version__} has changed {changed}"


ENTRY = """
from idealgas.jit import njit
from idealgas.engine.law import law

@njit
def entry(x):
    return law(x) + 1
"""
LAW = """
from idealgas.jit import inline

@inline
def law(x):
    return {} * x
"""
CALL = """
from idealgas.engine.entry import entry
print(entry(20), *(sum(each.values()) for each in (entry.compiled.stats.cache_hits, entry.compiled.stats.cache_misses)))
"""


@pytest.fixture
def package(tmp_path):
    """A folder with a package that has this one's compilation and two modules of its own."""
    folder = tmp_path / "sources" / "idealgas"
    (folder / "engine").mkdir(parents=True)
    for path in (folder / "__init__.py", folder / "engine" / "__init__.py"):
        path.touch()
    shutil.copytree(ROOT / "idealgas" / "jit", folder / "jit")
    for name in ("system.py", "errors.py"):
        shutil.copy(ROOT / "idealgas" / name, folder)
    (folder / "engine" / "entry.py").write_text(ENTRY)
    (folder / "engine" / "law.py").write_text(LAW.format(2))
    return folder


@pytest.fixture
def cached(tmp_path):
    """An empty cache."""
    return {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}


def stored(cached):
    """Files with machine code in a cache."""
    return [path for path in Path(cached["NUMBA_CACHE_DIR"]).rglob("*") if path.is_file()]


@pytest.mark.slow
def test_a_second_process_loads_what_the_first_compiled_until_another_file_changes(package, cached):
    assert python(CALL, package.parent, **cached) == "41 0 1"
    assert python(CALL, package.parent, **cached) == "41 1 0"
    (folder,) = Path(cached["NUMBA_CACHE_DIR"]).iterdir()
    assert folder.stat().st_mode & 0o777 == 0o700
    (package / "engine" / "law.py").write_text(LAW.format(3))
    assert python(CALL, package.parent, **cached) == "61 0 1"


@pytest.mark.slow
def test_several_processes_compile_at_once(package, cached):
    """For the same and for other types of arguments; afterwards each finds its own machine code or compiles it."""
    programs = [CALL, CALL.replace("20", "20.0")]
    processes = [start(program, package.parent, **cached) for program in programs * 2]
    done = [(*process.communicate(), process.returncode) for process in processes]
    assert [(output.split()[0], errors, code) for output, errors, code in done] == [("41", "", 0), ("41.0", "", 0)] * 2
    for program in programs:
        python(program, package.parent, **cached)
    assert [python(program, package.parent, **cached) for program in programs] == ["41 1 0", "41.0 1 0"]


@pytest.mark.slow
def test_damaged_and_swapped_files_are_compiled_again(package, cached):
    """Two processes that save at once may give machine code for different types the same file name."""
    whole = CALL.replace("20", "20.0")
    python(CALL, package.parent, **cached)
    (code,) = stored(cached)
    for_integers = code.read_bytes()
    shutil.rmtree(cached["NUMBA_CACHE_DIR"])
    python(whole, package.parent, **cached)
    (code,) = stored(cached)
    right = code.read_bytes()
    for damaged in (for_integers, right[:1000], right[:-1], right[:-1] + bytes([right[-1] ^ 1]), b""):
        code.write_bytes(damaged)
        assert python(whole, package.parent, **cached).startswith("41.0 ")
        assert python(whole, package.parent, **cached) == "41.0 1 0"


@pytest.mark.slow
def test_a_temporary_cache_where_no_other_can_be_written(package, tmp_path):
    (tmp_path / "file").touch()
    (tmp_path / "temporary").mkdir()
    (tmp_path / "temporary" / f"idealgas-{os.geteuid()}").touch()
    variables = {"NUMBA_CACHE_DIR": str(tmp_path / "file"), "TMPDIR": str(tmp_path / "temporary")}
    assert python(CALL, package.parent, **variables) == "41 0 1"
    assert [path.name for path in (tmp_path / "temporary").iterdir()] == [f"idealgas-{os.geteuid()}"]


OLD = """
import os, time
from pathlib import Path
base = Path(os.environ["NUMBA_CACHE_DIR"])
for days in range(9):
    (base / f"idealgas-{days}").mkdir(parents=True)
    os.utime(base / f"idealgas-{days}", 2 * (time.time() - 86400 * days / 2,))
(base / "other").mkdir()
os.utime(base / "other", (0, 0))
from idealgas.jit.files import cache_folder
own = cache_folder()
print(*sorted(path.name for path in base.iterdir() if path != own))
"""


def test_old_folders_are_removed(package, cached):
    """The five used last stay, like all that another program has made."""
    assert python(OLD, package.parent, **cached) == "idealgas-0 idealgas-1 idealgas-2 idealgas-3 other"


def test_without_compilation(package, cached):
    program = "from idealgas.engine.entry import entry; print(entry(20), type(entry).__name__)"
    assert python(program, package.parent, NUMBA_DISABLE_JIT="1", **cached) == "41 function"


PREFETCHING = """
from idealgas.jit import njit, prefetch_next_line

@njit
def entry(column, row):
    prefetch_next_line(column, row)
"""
BEYOND_THE_END = """
import numpy as np
from idealgas.engine.entry import entry
from idealgas.jit import prefetch_next_line
for column in (np.arange(3.0), np.ones((3, 2)), np.zeros(3, np.uint8)):
    before = column.copy()
    assert prefetch_next_line(column, 2) is None and entry(column, np.uintp(2)) is None
    assert (column == before).all()
print(*(code.count("call void @llvm.prefetch") for code in entry.compiled.inspect_llvm().values()))
"""


@pytest.mark.slow
def test_prefetching_beyond_an_array_changes_nothing(package, cached):
    """The last row has no line behind it; in Python nothing is prefetched."""
    (package / "engine" / "entry.py").write_text(PREFETCHING)
    assert python(BEYOND_THE_END, package.parent, **cached) == "1 1 1"


FOLDER = "from idealgas.jit.files import cache_folder; print(cache_folder())"


def cache_folder_with(folder, **environment):
    """Cache folder of a fresh Python in a folder, with no other variables; it still exists unless it was temporary."""
    return Path(python(FOLDER, folder, TMPDIR=str(folder / "tmp"), **environment))


@pytest.fixture
def place(tmp_path):
    """An empty folder with an empty folder for temporary files."""
    (tmp_path / "tmp").mkdir()
    return tmp_path


@posix
@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"NUMBA_CACHE_DIR": "{}/one", "XDG_CACHE_HOME": "{}/two", "HOME": "{}/three"}, "one"),
        ({"XDG_CACHE_HOME": "{}/two", "HOME": "{}/three"}, "two/idealgas"),
        ({"HOME": "{}/three"}, "three/.cache/idealgas"),
        ({"XDG_CACHE_HOME": "cache", "HOME": "{}/three"}, "three/.cache/idealgas"),
        ({"HOME": "~"}, f"tmp/idealgas-{os.geteuid() if hasattr(os, 'geteuid') else 0}"),
    ],
    ids=["given", "of caches", "of the user", "relative", "no home"],
)
def test_base_of_the_cache(place, variables, expected):
    """XDG Base Directory Specification: relative ones are invalid. `expanduser` leaves "~" of a user without a home."""
    for _ in range(2):
        result = cache_folder_with(place, **{name: value.format(place) for name, value in variables.items()})
        assert result.parent == place / expected
        assert result.stat().st_mode & 0o777 == 0o700
        assert "idealgas" not in expected or result.parent.stat().st_mode & 0o777 == 0o700
    assert {path.name for path in place.iterdir()} == {"tmp", expected.partition("/")[0]}


@posix
@pytest.mark.parametrize(
    "what",
    [
        pytest.param("owner", marks=root),
        "writable",
        "link",
        "writable above",
        pytest.param("owner above", marks=root),
    ],
)
def test_a_cache_that_others_can_write_is_not_read(place, what):
    cached = {"NUMBA_CACHE_DIR": str(place / "cache")}
    own = cache_folder_with(place, **cached)
    assert own.parent == place / "cache"
    planted = own.parent if "above" in what else own
    if "owner" in what:
        os.chown(planted, 12345, 12345)
    elif "writable" in what:
        planted.chmod(0o777)
    else:
        own.rename(place / "elsewhere")
        own.symlink_to(place / "elsewhere")
    (own / "planted").touch()
    result = cache_folder_with(place, **cached)
    assert result.parent == place / "tmp" / f"idealgas-{os.geteuid()}"
    if "owner" in what and what != "owner":
        shutil.rmtree(own)
        cache_folder_with(place, **cached)
        assert not own.exists(), "nothing is made in a folder of another user"


@pytest.mark.parametrize("error", [OSError, RuntimeError, ValueError])
def test_compilation_that_fails_is_no_error_of_a_file(error):
    """Readers take these errors for damage of what they read."""

    def fail(_):
        raise error("no memory\nfor code")

    entry = EntryPoint(lambda: 0)
    _ = entry.compiled
    entry._compile = fail
    with pytest.raises(UserError, match=r"^compilation failed: no memory for code$"):
        entry()
