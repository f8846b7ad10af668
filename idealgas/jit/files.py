"""Machine code on disk: a folder for each combination of compiler versions and processor, and a file for each result.

A file contains the machine code of an entry point for given argument types, and the digests of everything from which
the code was made. There may be several files with different digests, for example from several branches of the source.
"""

import atexit
import hashlib
import os
import pickle
import shutil
import sys
import tempfile
import time
import zlib
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np

from idealgas import system

_FOLDERS, _SIGNATURES, _VERSIONS = 5, 500, 5
"""Numbers of folders, of entry points with argument types, and of versions of each, kept at any age."""
_LIFETIME = 24 * 3600  # seconds since the last use after which any other file or folder is removed


@cache
def cache_folder() -> Path:
    """Return the folder for the machine code of this process, which is created on the first call.

    The folder is in NUMBA_CACHE_DIR if this variable is set, otherwise in `idealgas` in the user's cache folder. If
    that is not usable, it is in a folder of the user among the temporary files and, as a last resort, it is a temporary
    folder. Machine code is loaded without further checks, so a folder that another user owns or can write to is not
    used.
    """
    import numba

    home = system.cache_home()
    users = Path(numba.config.CACHE_DIR).absolute() if numba.config.CACHE_DIR else home and home / "idealgas"
    for base in filter(None, (users, Path(tempfile.gettempdir(), f"idealgas-{system.user_number()}").absolute())):
        folder = base / f"idealgas-{_compilers()}"
        with suppress(OSError):
            if system.make_private(folder):
                os.utime(folder)  # marked as used now, so that no other process removes it
                tempfile.TemporaryFile(dir=folder).close()
                _remove_old(base.glob("idealgas-*"), _FOLDERS)
                return folder
    folder = Path(tempfile.mkdtemp(prefix="idealgas-"))
    atexit.register(_remove_if_own, folder, os.getpid())
    return folder


def _compilers() -> str:
    """Return a digest of everything on which machine code depends, apart from the functions themselves."""
    import numba
    from llvmlite import binding

    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    versions = sys.version, numba.__version__, binding.llvm_version_info, np.__version__
    processor = [binding.get_process_triple(), binding.get_host_cpu_name()]
    with suppress(RuntimeError):  # if the features are unknown, they are not used either
        processor.append(binding.get_host_cpu_features().flatten())
    options = sorted((name, os.environ[name]) for name in os.environ if name[:6] == "NUMBA_" and "CACHE" not in name)
    digest.update(f"{versions} {processor} {options}".encode(errors="surrogatepass"))
    return digest.hexdigest()[:16]


def _remove_if_own(folder: Path, process: int) -> None:
    """Remove the temporary folder of a process; forked children also call this function but leave the folder alone."""
    if os.getpid() == process:
        shutil.rmtree(folder, ignore_errors=True)


def _remove_old(paths: Iterable[Path], kept: int) -> None:
    """Remove all paths except the most recently used; another process may be doing the same."""
    with suppress(OSError):
        used = sorted(((path.stat().st_mtime, path) for path in paths), reverse=True)
        for last, path in used[kept:]:
            if last < time.time() - _LIFETIME:
                shutil.rmtree(path) if path.is_dir() else path.unlink()


def _folder(name: str, signature: str) -> Path:
    digest = hashlib.sha256(f"{name} {signature}".encode()).hexdigest()
    return cache_folder() / f"{name.rpartition('.')[2]}-{digest[:16]}"


def load(name: str, signature: str, digest: Callable[[str], str]) -> tuple[set[str], bytes]:
    """Load machine code that is up to date.

    Args:
        name: name of an entry point.
        signature: types of its arguments.
        digest: function that returns the current digest of the functions with a given key.

    Returns:
        The keys of the functions on which the machine code depends, and the machine code.

    Raises:
        LookupError: there is no machine code that is up to date.
    """
    folder = _folder(name, signature)
    for path in folder.iterdir() if folder.is_dir() else ():
        with suppress(Exception):  # damaged files may raise almost any error
            data = path.read_bytes()
            if zlib.crc32(data[4:]) == int.from_bytes(data[:4], "little"):
                stored, digests, code = pickle.loads(data[4:])
                if stored == signature and all(digest(key) == value for key, value in digests.items()):
                    for used in (path, folder):
                        os.utime(used)
                    return set(digests), code
    raise LookupError


def save(name: str, signature: str, digests: dict[str, str], code: bytes) -> None:
    """Save machine code, with the digests of the functions on which it depends by key."""
    folder = _folder(name, signature)
    folder.mkdir(0o700, exist_ok=True)
    data = pickle.dumps((signature, digests, code))
    version = hashlib.sha256(repr(sorted(digests.items())).encode()).hexdigest()[:16]
    with tempfile.TemporaryDirectory(dir=folder) as place:
        part = Path(place, version)
        part.write_bytes(zlib.crc32(data).to_bytes(4, "little") + data)
        part.replace(folder / version)
    _remove_old(folder.iterdir(), _VERSIONS)
    _remove_old(cache_folder().iterdir(), _SIGNATURES)
