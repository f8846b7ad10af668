"""Compilation, in one place: `njit` caches machine code under a digest of the sources from which it is made.

numba's own cache looks at one file only and serves outdated code when a callee in another file changes. Here the folder
of an entry point is named after the source of its module, the sources of all that this imports, and the versions of the
compilers; numba itself separates processors. The folders of each module used last are kept.
"""

import atexit
import hashlib
import os
import pickle
import re
import shutil
import sys
import tempfile
from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
from functools import cache
from importlib.util import resolve_name
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, _CacheLocator
from numba.core.event import TimingListener, install_listener
from numba.core.runtime import rtsys
from numba.core.serialize import dumps
from numba.core.types.containers import BaseTuple
from numba.core.typing.templates import infer_global
from numba.extending import overload as _overload

from idealgas._compiler import Compiler, PartType

if numba.config.DISABLE_JIT:
    np.seterr(divide="ignore", invalid="ignore", over="ignore")  # like compiled code, give no warnings

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "_nrt": False, "pipeline_class": Compiler}
"""Without numba's runtime, arrays are not reference-counted, and none can be made: the caller keeps them alive.

Counting takes an atomic operation wherever LLVM cannot prove it needless, up to half of an event loop's time, and a
fifth of the compilation's. `Compiler` leaves out more of it.
"""

CACHE_LINE = 64  # bytes

_KEPT = 3  # folders of a module that are not removed
_FOLDER = re.compile(r"[0-9a-f]{16}")  # the name of such a folder; nothing else is ever removed
_COMPILERS = f"{sys.implementation.cache_tag} {numba.__version__} {llvmlite.__version__} {np.__version__}"

_FOR_TYPE_CHECKERS = re.compile(
    r"^([ \t]*)if (?:typing\.)?TYPE_CHECKING:.*\n(?:(?:\1[ \t]+\S.*|[ \t]*)\n)*", re.MULTILINE
)
_IMPORT = re.compile(r"import\b(?=[ \t]*(?:\(((?:#.*|[^)#])*)|([^;\n]*)))")  # the keyword, with what is imported
_ORIGIN = re.compile(r"(?:^|[;:])[ \t]*(?:from[ \t]+([\w.]+)[ \t]*)?\Z")  # what precedes the keyword in its line
_COMMENT = re.compile(r"#.*")


@cache
def _read(path: str) -> tuple[bytes, list[tuple[str, str]]]:
    """Digest of a source file and all its imports: modules, each with the name imported from it or an empty one.

    Imports are found by patterns: to parse all sources of an engine takes a tenth of a second. A text that looks like
    an import merely adds to a digest; what is imported for type checkers alone is never compiled.
    """
    with open(path, "rb") as file:
        content = file.read()
    source = content.decode("utf-8", "replace").replace("\r\n", "\n").replace("\\\n", " ")
    if "TYPE_CHECKING" in source:
        source = _FOR_TYPE_CHECKERS.sub("", source)
    imports: list[tuple[str, str]] = []
    for found in _IMPORT.finditer(source):
        line = source.rfind("\n", 0, found.start()) + 1
        if before := _ORIGIN.search(source[line : found.start()]):
            items = map(str.split, _COMMENT.sub("", found[1] or found[2]).split(","))
            imports.extend((before[1], words[0]) if before[1] else (words[0], "") for words in items if words)
    return hashlib.sha256(content).digest(), imports


@cache
def _file_of(module: str) -> str | None:
    """Path of the source of a module, whose package is imported already; None if there is no such module."""
    top, *names = module.split(".")
    for folder in getattr(sys.modules.get(top), "__path__", ()):
        path = os.path.join(folder, *names)
        for file in (os.path.join(path, "__init__.py"), f"{path}.py"):
            if os.path.isfile(file):
                return file
    return None


@cache
def _imported(module: str, file: str, packages: frozenset[str]) -> dict[str, str]:
    """Modules of these packages that a module imports, by name, with the paths of their sources.

    A name imported from a package is its submodule of that name, else something from its `__init__`. The `__init__` of
    other packages is run as well, but gives the importing module nothing to call.
    """
    package = module if os.path.basename(file) == "__init__.py" else module.rpartition(".")[0]
    found = {}
    for origin, name in _read(file)[1]:
        with suppress(ImportError):  # a relative import outside a package
            origin = resolve_name(origin, package)
        if origin.split(".")[0] in packages:
            for candidate in (f"{origin}.{name}", origin) if name else (origin,):
                if source := _file_of(candidate):
                    found[candidate] = source
                    break
    return found


@cache
def _sources(module: str, file: str) -> dict[str, str]:
    """Modules that determine the machine code of a module's functions, see `compiled_from`."""
    packages = frozenset({__name__.split(".")[0], module.split(".")[0]})
    sources = {__name__: __file__, module: file}
    new = list(sources)
    while new:
        name = new.pop()
        for imported, source in _imported(name, sources[name], packages).items():
            if imported not in sources:
                sources[imported] = source
                new.append(imported)
    return sources


def compiled_from(function: Callable) -> dict[str, str]:
    """Modules whose sources determine a function's machine code, by name, with the paths of their sources.

    They are this module, the function's own, and all modules of these two packages that they import, directly or not:
    by statements anywhere in them, but not by those for type checkers alone.
    """
    return _sources(function.__module__, function.__code__.co_filename)


def _digest(module: str, file: str) -> str:
    """Digest of everything that determines the machine code of a module's functions."""
    digest = hashlib.sha256(_COMPILERS.encode())
    if _file_of(module) is None:  # in no package: imports from its own folder are not followed
        digest.update(file.encode())
    for name, source in sorted(_sources(module, file).items()):
        digest.update(name.encode() + _read(source)[0])
    return digest.hexdigest()[:16]


@cache
def _temporary_base() -> Path:
    """Temporary folder of this process, removed at its end."""
    folder = Path(tempfile.mkdtemp(prefix="idealgas-"))
    atexit.register(_remove_if_own, folder, os.getpid())
    return folder


def _remove_if_own(folder: Path, process: int) -> None:
    """Remove a process's temporary folder; its forked children call this too, and leave the folder."""
    if os.getpid() == process:
        shutil.rmtree(folder, ignore_errors=True)


def _make(folder: Path) -> Path:
    """Mark a folder of machine code as used, before anything else, so that no other process removes it."""
    try:
        os.utime(folder)
    except FileNotFoundError:
        folder.mkdir(parents=True, exist_ok=True)
        _remove_old(folder)
    return folder


def _remove_old(new: Path) -> None:
    """Remove a module's folders but the new one and those used last; another process may be doing so as well."""
    with suppress(OSError):
        others = [
            entry
            for entry in os.scandir(new.parent)
            if _FOLDER.fullmatch(entry.name) and entry.name != new.name and entry.is_dir(follow_symlinks=False)
        ]
        others.sort(key=lambda entry: entry.stat().st_mtime_ns, reverse=True)
        for entry in others[_KEPT - 1 :]:
            shutil.rmtree(entry.path, ignore_errors=True)


@cache
def _folder(module: str, file: str) -> Path:
    """Folder of the machine code of a module's functions, see `cache_folder`."""
    base = os.environ.get("NUMBA_CACHE_DIR") or os.path.join(
        os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "idealgas"
    )
    path = Path(module, _digest(module, file))
    try:
        return _make(base / path)
    except OSError:
        return _make(_temporary_base() / path)


def cache_folder(function: Callable) -> Path:
    """Folder of a function's machine code, made on first use; a temporary one where no other can be written."""
    return _folder(function.__module__, function.__code__.co_filename)


def _fields(kind: Any) -> tuple:
    """Names of the fields of all named tuples in a signature, which numba compares by class and fields' types only."""
    if not isinstance(kind, tuple | BaseTuple):
        return ()
    return getattr(getattr(kind, "instance_class", None), "_fields", ()), *map(_fields, kind)


class _Locator(_CacheLocator):
    """Gives numba the folder of a function's machine code, whose name depends on all sources already."""

    def __init__(self, function: Callable, file: str) -> None:
        self._py_file = file
        self._line = function.__code__.co_firstlineno
        self._folder = cache_folder(function)

    @classmethod
    def from_function(cls, function: Callable, file: str) -> "_Locator":
        return cls(function, file)

    def get_cache_path(self) -> str:
        return str(self._folder)

    def get_source_stamp(self) -> str:
        return self._folder.name

    def get_disambiguator(self) -> str:
        return str(self._line)


class _Code(CompileResultCacheImpl):
    _locator_classes = (_Locator,)


class _Files(IndexDataCacheFile):
    """numba's files of machine code, where a file that cannot be read counts as absent and is written anew.

    Each piece of machine code is stored with its key and a digest: two processes that save at once may give two pieces
    the same name, and a damaged one would crash.
    """

    def load(self, key: Any) -> Any:
        key = key, _fields(key[0])
        try:
            digest, content = super().load(key)
            saved, data = pickle.loads(content) if hashlib.sha256(content).digest() == digest else (None, None)
        except Exception:  # absent or damaged, which may raise almost any error
            return None
        return data if saved == key else None

    def save(self, key: Any, data: Any) -> None:
        key = key, _fields(key[0])
        content = dumps((key, data))
        super().save(key, (hashlib.sha256(content).digest(), content))

    def _load_index(self) -> dict:
        try:
            return super()._load_index()
        except Exception:
            return {}


class _Cache(FunctionCache):
    """numba's cache of a function, with the files above; what cannot be saved is compiled again next time."""

    _impl_class = _Code

    def __init__(self, function: Callable) -> None:
        super().__init__(function)
        code = self._impl
        self._cache_file = _Files(self.cache_path, code.filename_base, code.locator.get_source_stamp())

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load machine code without all that only compilation needs: more than half a second in each process."""
        rtsys.initialize(target_context)  # arrays come in by functions of numba's runtime
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)

    def save_overload(self, sig: Any, data: Any) -> None:
        with suppress(OSError):
            super().save_overload(sig, data)


def njit(function: Callable) -> Any:
    """Compile an entry point: without fastmath and without the GIL, cached on disk if its source is a file.

    Where an inlined function calls it, it stays out of line: numba would inherit `forceinline` from there.
    """
    compiled = numba.njit(function, no_cfunc_wrapper=True, forceinline=False, **_OPTIONS)
    if not numba.config.DISABLE_JIT and os.path.isfile(function.__code__.co_filename):
        compiled._cache = _Cache(function)
    return compiled


_PART: dict[str, Any] = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True, **_OPTIONS}
_INLINE: dict[str, Any] = {"forceinline": True, **_PART}


def inline(function: Callable) -> Any:
    """Compile a small function that LLVM inserts into the entry points that call it; in Python it stays as it is."""
    return _make_part(function, _INLINE)


def noinline(function: Callable) -> Any:
    """Compile a long or rarely called function as part of its entry points; in Python it stays as it is."""
    return _make_part(function, {"forceinline": False, **_PART})


def _make_part(function: Callable, options: dict[str, Any]) -> Callable:
    """Let entry points call a function, compiled with these options."""
    if not numba.config.DISABLE_JIT:
        infer_global(function, PartType(numba.njit(function, **options)))
    return function


def overload(function: Callable) -> Callable:
    """Decorate a function that chooses inlined code by the types of its arguments; `function` is what Python calls."""
    return _overload(function, jit_options=_INLINE)


def compile_timer() -> AbstractContextManager[TimingListener]:
    """Measure the seconds spent on making machine code or loading it, as `duration` once `done` is true."""
    return install_listener("numba:compile", TimingListener())


def aligned(n: int, dtype: np.dtype, boundary: int = CACHE_LINE) -> Any:
    """Array of n zeros in cache lines that nothing else is in; a record array if the dtype is structured."""
    raw = np.zeros((-(-n * dtype.itemsize // boundary) + 1) * boundary, np.uint8)
    start = -raw.__array_interface__["data"][0] % boundary
    kind: Any = np.recarray if dtype.names else np.ndarray
    return kind(n, dtype, raw, start)
