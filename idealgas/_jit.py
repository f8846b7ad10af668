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
from numba.core.event import TimingListener, install_listener
from numba.extending import register_jitable

if numba.config.DISABLE_JIT:
    np.seterr(divide="ignore", invalid="ignore", over="ignore")  # as silent as compiled code

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "_nrt": False}
"""Without numba's runtime arrays are not reference-counted, and none can be made: the caller keeps them alive. Counting
takes an atomic operation wherever LLVM cannot prove it needless, up to half of an event loop's time, and a fifth of the
compilation's."""


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


def compile_timer() -> AbstractContextManager[TimingListener]:
    """Measure, as `duration` if `done`, the seconds spent on making machine code or loading it."""
    return install_listener("numba:compile", TimingListener())
