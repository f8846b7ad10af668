"""A first reading of a log in a process of its own: a file made for it crashes HDF5, or keeps it busy for ever."""

import faulthandler
import os
import signal
import sys
import warnings
from functools import lru_cache
from pathlib import Path
from typing import NoReturn

import h5py

from idealgas.log.errors import DamageError
from idealgas.log.hdf5.safe_hdf5 import layout_of, open_object
from idealgas.log.hdf5.superblock import Unmarked, is_marked

SECONDS = 4
"""Of the processor's time that opening a log and reading all its indexes may take."""

MEMORY = 2**30
"""Bytes that this may map beyond what is mapped before."""

DEPTH = 4
"""Groups within groups that are looked at."""

OUT_OF_MEMORY = 3
"""Exit status of the process."""


def try_reading(path: str | os.PathLike[str]) -> None:
    """Open a log and read the indexes of its columns in a forked process, which bears what HDF5 may do.

    For commands, before they open it themselves: a program with threads must not fork. Only Linux has the trial, as a
    fork is not safe beside the libraries of other systems. Raises DamageError if HDF5 crashes, does not end, or asks
    for far too much memory. Other faults are left to those who read the log then, and say them better.
    """
    try:
        status = os.stat(path)
    except OSError:
        return
    if sys.platform == "linux":
        _try(Path(path), (status.st_ino, status.st_size, status.st_mtime_ns))


@lru_cache(maxsize=1)  # commands that open a log twice fork once, before they have threads
def _try(path: Path, version: tuple[int, ...]) -> None:
    """Fork and wait; version: of the file, which is not tried again while it is the same."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # threads of numpy's libraries, which are not used here
        child = os.fork()
    if not child:
        _read(path)
    _, status = os.waitpid(child, 0)
    code = os.waitstatus_to_exitcode(status)
    if code == -signal.SIGXCPU:
        raise DamageError(path, f"HDF5 does not come to an end in reading it ({SECONDS} s)")
    if code == OUT_OF_MEMORY:
        raise DamageError(path, f"HDF5 asks for more than {MEMORY:,} bytes to read its structure")
    if code < 0 and code not in (-signal.SIGKILL, -signal.SIGTERM):
        raise DamageError(path, f"HDF5 crashes in reading it ({signal.Signals(-code).name})")


def _read(path: Path) -> NoReturn:
    """The forked process, which does not return."""
    code = 0
    try:
        faulthandler.disable()
        _limit()
        with h5py.File(Unmarked(path) if is_marked(path) else path, "r") as file:
            _walk(open_object(file, "/"), DEPTH)
    except Exception as error:
        code = _code(error)
    finally:
        os._exit(code)


def _code(error: Exception) -> int:
    """Exit status for an error; 0 for one that the command will find and say itself."""
    return OUT_OF_MEMORY if isinstance(error, MemoryError) or "memory allocation failed" in str(error) else 0


def _walk(group: h5py.h5g.GroupID, depth: int) -> None:
    """Open all that lies in a group, and read the indexes of its datasets; only a lack of memory ends it."""
    for name in group:
        try:
            if group.links.get_info(name).type == h5py.h5l.TYPE_HARD:
                found = h5py.h5o.open(group, name)
                if isinstance(found, h5py.h5d.DatasetID):
                    layout_of(found)
                    found.get_num_chunks()
                elif isinstance(found, h5py.h5g.GroupID) and depth:
                    _walk(found, depth - 1)
        except Exception as error:
            if _code(error):
                raise


def _limit() -> None:
    import resource  # not on every system

    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (mapped + MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))
