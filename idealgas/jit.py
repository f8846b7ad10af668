"""Compilation, in one place: `njit` and parts of what it compiles, prefetching, aligned memory.

Machine code is cached on disk by numba, which looks only at the source file of an entry point and would serve outdated
code when a function in another file changes. So the cache is in a folder named by a digest of all sources that hold
compiled code, and of the versions of the compilers.

numba is imported when the first entry point is called: commands that compile nothing start without it.
"""

import atexit
import hashlib
import os
import shutil
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, cached_property, update_wrapper
from pathlib import Path
from typing import Any

import numpy as np

from idealgas import system
from idealgas.errors import UserError

INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
if INTERPRETED:
    np.seterr(divide="ignore", invalid="ignore", over="ignore")  # like compiled code, give no warnings

CACHE_LINE = 64  # bytes

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "_nrt": False, "no_cfunc_wrapper": True}
"""Without numba's runtime, arrays are not reference-counted, and none can be made: the caller keeps them alive.

Counting takes an atomic operation wherever LLVM cannot prove it needless, and makes the event loop five times slower.
"""
_PART: dict[str, Any] = {"no_cpython_wrapper": True, **_OPTIONS}
_INLINE: dict[str, Any] = {"forceinline": True, **_PART}

_PACKAGE = Path(__file__).parent
_KEPT = 5  # cache folders that are kept however old they are
_LIFETIME = 24 * 3600  # seconds since its last use after which another one is removed


def sources() -> dict[Path, bytes]:
    """Source files that determine the machine code: laws, effects, engine, and others that import this module."""
    files = {path: path.read_bytes() for path in sorted(_PACKAGE.rglob("*.py"))}
    return {
        path: source
        for path, source in files.items()
        if path.parent == _PACKAGE
        or path.relative_to(_PACKAGE).parts[0] in ("physics", "effects", "engine")
        or b"idealgas.jit" in source
    }


@cache
def cache_folder() -> Path:
    """Folder of this process's machine code, made on the first call; a temporary one if no other can be used.

    It is in NUMBA_CACHE_DIR if that is set, else in `idealgas` in the user's cache folder, else in a folder of the user
    among the temporary files. Machine code is loaded without further checks, so a folder that another user owns or can
    write is not used.
    """
    import llvmlite
    import numba

    digest = hashlib.sha256(f"{sys.version} {numba.__version__} {llvmlite.__version__} {np.__version__}".encode())
    for path, source in sources().items():
        digest.update(f"{path.relative_to(_PACKAGE)} {len(source)} ".encode() + source)
    home = system.cache_home()
    users = Path(numba.config.CACHE_DIR).absolute() if numba.config.CACHE_DIR else home and home / "idealgas"
    for base in filter(None, (users, Path(tempfile.gettempdir(), f"idealgas-{system.user_number()}").absolute())):
        folder = base / f"idealgas-{digest.hexdigest()[:16]}"
        with suppress(OSError):
            if system.make_private(folder):
                os.utime(folder)  # used now, so that no other process removes it
                tempfile.TemporaryFile(dir=folder).close()
                _remove_old(base)
                return folder
    folder = Path(tempfile.mkdtemp(prefix="idealgas-"))
    atexit.register(_remove_if_own, folder, os.getpid())
    return folder


def _remove_if_own(folder: Path, process: int) -> None:
    """Remove a process's temporary folder; forked children call this too, and leave the folder."""
    if os.getpid() == process:
        shutil.rmtree(folder, ignore_errors=True)


def _remove_old(base: Path) -> None:
    """Remove cache folders but those used last; another process may be doing so as well."""
    with suppress(OSError):
        used = sorted(((path.stat().st_mtime, path) for path in base.glob("idealgas-*")), reverse=True)
        for last, path in used[_KEPT:]:
            if last < time.time() - _LIFETIME:
                shutil.rmtree(path, ignore_errors=True)


_declared: list[Callable[[], object]] = []
"""Declarations of inlined and other functions to numba, made when the first entry point is compiled."""
_lock = threading.RLock()
_local = threading.local()


class EntryPoint:
    """A function that is compiled when it is first called: without fastmath and without the GIL, cached on disk.

    Where another compiled function calls it, it is not inlined: numba would inherit `forceinline` from there.
    """

    def __init__(self, function: Callable) -> None:
        """Take the function in Python."""
        self.py_func = function
        update_wrapper(self, function)
        _declare(self, function, {"forceinline": False, **_PART})

    def __call__(self, *arguments: Any) -> Any:
        """Call the machine code, or the function itself in a block of `in_python`."""
        return (self.py_func if getattr(_local, "in_python", False) else self.compiled)(*arguments)

    @cached_property
    def compiled(self) -> Any:
        """Numba's dispatcher of the function."""
        import numba

        with _lock:
            while _declared:
                _declared.pop(0)()
            own = Path(self.py_func.__code__.co_filename).is_relative_to(_PACKAGE)  # only these are in the digest
            before = numba.config.CACHE_DIR
            numba.config.CACHE_DIR = str(cache_folder()) if own else before
            try:
                compiled = numba.njit(self.py_func, cache=own, forceinline=False, **_OPTIONS)
            finally:
                numba.config.CACHE_DIR = before
            compiled.compile = _watched(compiled)
            return compiled


def njit(function: Callable) -> Any:
    """Make a function an entry point of compiled code, see `EntryPoint`."""
    return function if INTERPRETED else EntryPoint(function)


@contextmanager
def in_python(little: bool) -> Iterator[None]:
    """Call entry points that have little to do as functions of Python, with the same results bit for bit.

    Where numba is not loaded yet, that takes less time than to load it.
    """
    _local.in_python = little and "numba" not in sys.modules
    try:
        yield
    finally:
        _local.in_python = False


def when_compiling(declare: Callable[[], object]) -> Callable[[], object]:
    """Decorate a function that declares something to numba, to be called before the first entry point is compiled."""
    if not INTERPRETED:
        _declared.append(declare)
    return declare


def _declare(name: Any, function: Callable, options: dict[str, Any]) -> None:
    """Let compiled code call `function` by a name."""

    @when_compiling
    def declare() -> None:
        from numba.extending import overload

        overload(name, jit_options=options, strict=False)(lambda *arguments: function)


_seconds = 0.0


def compile_seconds() -> float:
    """Seconds that this process has spent on compiling entry points or loading their machine code."""
    return _seconds


def _watched(compiled: Any) -> Callable:
    """An entry point's compilation, measured, and repeated without the cache where files are damaged or of other code.

    Where two processes save machine code of one function for different types at once, both may use the same file name.
    """
    import numba

    make = compiled.compile

    def compile_for(signature: tuple) -> Any:
        global _seconds
        before, started = _seconds, time.perf_counter()
        try:
            make(signature)
        except numba.errors.NumbaError:
            raise
        except Exception:  # a file that cannot be written or read; what is damaged may raise almost anything
            pass
        finally:
            _seconds = before + time.perf_counter() - started  # with that of entry points called by this one
        if signature not in compiled.signatures:
            shutil.rmtree(cache_folder(), ignore_errors=True)
        try:
            return make(signature)  # at once, if it is compiled
        except (OSError, RuntimeError, ValueError) as error:  # which callers take for errors of a file that they read
            raise UserError(f"compilation failed: {' '.join(str(error).split())}") from error

    return compile_for


def inline(function: Callable) -> Any:
    """Compile a small function that LLVM inserts into the entry points that call it; in Python it stays as it is."""
    _declare(function, function, _INLINE)
    return function


def noinline(function: Callable) -> Any:
    """Compile a long or rarely called function as part of its entry points; in Python it stays as it is."""
    _declare(function, function, {"forceinline": False, **_PART})
    return function


def overload(function: Callable) -> Callable:
    """Decorate a function that chooses inlined code by the types of its arguments; `function` is what Python calls."""

    def decorate(choose: Callable) -> Callable:
        @when_compiling
        def declare() -> None:
            from numba.extending import overload

            overload(function, jit_options=_INLINE)(choose)

        return choose

    return decorate


def intrinsic(function: Callable) -> Callable:
    """Decorate a function that numba's `intrinsic` takes: compiled code calls it, Python cannot."""

    def declared(*arguments: Any) -> Any:
        raise TypeError(f"{function.__name__} is for compiled code only")

    @when_compiling
    def declare() -> None:
        from numba.extending import intrinsic, overload

        made = intrinsic(function)
        overload(declared, jit_options=_INLINE, strict=False)(lambda *types: lambda *arguments: made(*arguments))

    return declared


def prefetch(array: Any, row: Any) -> None:
    """Prefetch the memory of a row, as it will be read soon; does nothing in Python."""


def prefetch_next_line(array: Any, row: Any) -> None:
    """Prefetch the memory one cache line after a row, as it will be written soon; does nothing in Python.

    Stores take effect in order: while one waits for memory that is not in a cache, all later ones wait too.
    """


def _prefetch(distance: int, for_writing: int) -> Callable:
    """Intrinsic function that prefetches what lies at a distance (bytes) from a row of an array."""

    @intrinsic
    def fetch(typing: Any, array: Any, row: Any) -> Any:
        from llvmlite import ir
        from numba import types

        def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            i32, byte = ir.IntType(32), ir.IntType(8).as_pointer()
            values = context.make_array(array)(context, builder, arguments[0])
            if array.ndim == 1 and array.layout == "C":
                start = builder.bitcast(builder.gep(values.data, [arguments[1]]), byte)
            else:
                offset = builder.mul(builder.extract_value(values.strides, 0), arguments[1])
                start = builder.gep(builder.bitcast(values.data, byte), [offset])
            address = builder.gep(start, [ir.IntType(64)(distance)])
            kind = ir.FunctionType(ir.VoidType(), [byte, i32, i32, i32])
            function = builder.module.declare_intrinsic("llvm.prefetch", [byte], kind)
            builder.call(function, [address, i32(for_writing), i32(3), i32(1)])  # into all cache levels, data
            return context.get_dummy_value()

        return types.void(array, types.intp), code

    return fetch


_fetch = _prefetch(0, 0)
_fetch_next_line = _prefetch(CACHE_LINE, 1)
overload(prefetch)(lambda array, row: lambda array, row: _fetch(array, row))
overload(prefetch_next_line)(lambda array, row: lambda array, row: _fetch_next_line(array, row))


def aligned(n: int, dtype: np.dtype) -> Any:
    """Array of n zeros in cache lines that nothing else is in; a record array if the dtype is structured."""
    raw = np.zeros((-(-n * dtype.itemsize // CACHE_LINE) + 1) * CACHE_LINE, np.uint8)
    start = -raw.__array_interface__["data"][0] % CACHE_LINE
    kind: Any = np.recarray if dtype.names else np.ndarray
    return kind(n, dtype, raw, start)
