"""Compilation, in one place: `njit` caches machine code under a digest of the package's sources.

numba's own cache looks at one file only and serves stale code when a callee in another file changes; a folder named
after all sources cannot.
"""

import hashlib
import os
import tempfile
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.event import TimingListener, install_listener
from numba.extending import lower_builtin, register_jitable, type_callable

if numba.config.DISABLE_JIT:
    np.seterr(divide="ignore", invalid="ignore", over="ignore")  # as silent as compiled code

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "_nrt": False}
"""Without numba's runtime arrays are not reference-counted, and none can be made: the caller keeps them alive. Counting
takes an atomic operation wherever LLVM cannot prove it needless, up to half of an event loop's time, and a fifth of the
compilation's."""

CACHE_LINE = 64  # bytes


@cache
def cache_folder() -> Path:
    """Folder of this version's machine code, made on first use; a temporary one where no other can be written."""
    digest = hashlib.sha256()
    package = Path(__file__).parent
    for source in sorted(package.rglob("*.py")):
        digest.update(source.relative_to(package).as_posix().encode())
        digest.update(source.read_bytes())
    base = os.environ.get("NUMBA_CACHE_DIR") or os.path.join(
        os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "idealgas"
    )
    folder = Path(base) / digest.hexdigest()[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError:
        return Path(tempfile.mkdtemp(prefix="idealgas-"))


def njit(function: Callable) -> Any:
    """Compile an entry point: no fastmath, no GIL, cached on disk."""
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(cache_folder())
    try:
        return numba.njit(function, cache=True, **_OPTIONS)
    finally:
        numba.config.CACHE_DIR = before


def inline(function: Callable) -> Any:
    """A small part that LLVM pastes into the entry points that call it; called from Python it stays Python."""
    return register_jitable(forceinline=True, no_cfunc_wrapper=True, **_OPTIONS)(function)


def fetch_next_line(array: Any, row: Any) -> None:
    """Bring the memory one cache line behind a row near, as it is about to be written; does nothing in Python.

    Stores take effect in order: while one waits for far memory, all behind it wait too.
    """


@type_callable(fetch_next_line)
def _type_of_fetch(context: Any) -> Callable:
    return lambda array, row: types.none


@lower_builtin(fetch_next_line, types.Array, types.Integer)
def _code_of_fetch(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind, (value, row) = signature.args[0], arguments
    array = context.make_array(kind)(context, builder, value)
    element = cgutils.get_item_pointer(context, builder, kind, array, [row] + [row.type(0)] * (kind.ndim - 1))
    place = builder.gep(builder.bitcast(element, cgutils.voidptr_t), [cgutils.intp_t(CACHE_LINE)])
    i32 = cgutils.int32_t
    prefetch = ir.FunctionType(ir.VoidType(), [place.type, i32, i32, i32])
    function = builder.module.declare_intrinsic("llvm.prefetch", [place.type], prefetch)
    builder.call(function, [place, i32(1), i32(3), i32(1)])  # to be written, into all caches, data
    return context.get_dummy_value()


def compile_timer() -> AbstractContextManager[TimingListener]:
    """Measure, as `duration` if `done`, the seconds spent on making machine code or loading it."""
    return install_listener("numba:compile", TimingListener())


def aligned(n: int, dtype: np.dtype, boundary: int = CACHE_LINE) -> Any:
    """Zeroed array on a cache-line boundary; a structured one as a record array."""
    raw = np.zeros(n * dtype.itemsize + boundary, np.uint8)
    start = -raw.ctypes.data % boundary
    array = raw[start : start + n * dtype.itemsize].view(dtype)
    return array.view(np.recarray) if dtype.names else array
