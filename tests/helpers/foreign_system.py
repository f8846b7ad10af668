"""Preamble of a Python that lacks what only POSIX has, for the modules of this package; imported by `sitecustomize`.

Locks are those of Windows, emulated: `LockFile` locks an open file. As on Windows, a file that is open in the process
can be neither moved, replaced nor removed.
"""

import builtins
import ctypes
import fcntl
import os
import struct
import types

HIDDEN = {"fcntl", "resource", "termios", "pwd", "grp"}
REMOVED = (
    "fork", "preadv", "pwritev", "symlink", "link", "geteuid", "mkfifo", "fchmod", "statvfs",
    "sched_getaffinity", "O_NONBLOCK", "O_DIRECTORY", "O_NOFOLLOW", "register_at_fork",
)  # fmt: skip

_import = builtins.__import__


_MSVCRT = types.SimpleNamespace(get_osfhandle=lambda descriptor: descriptor)


def _without_posix(name, *arguments, **options):
    importer = (arguments[0] if arguments else options.get("globals")) or {}
    if str(importer.get("__name__")).split(".")[0] in ("idealgas", "idealgas_cli"):
        if name in HIDDEN:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        if name == "msvcrt":
            return _MSVCRT
    return _import(name, *arguments, **options)


def _lock_file(handle, *_):
    try:
        fcntl.fcntl(handle, fcntl.F_OFD_SETLK, struct.pack("hhqqi0q", fcntl.F_WRLCK, 0, 0, 0, 0))
    except BlockingIOError:
        return 0
    except OSError:  # opened for reading: that lock is not exclusive, but in the way of one that is
        try:
            fcntl.fcntl(handle, fcntl.F_OFD_SETLK, struct.pack("hhqqi0q", fcntl.F_RDLCK, 0, 0, 0, 0))
        except BlockingIOError:
            return 0
    return 1


def _unless_open(action):
    def act(path, *arguments, **options):
        for place in (path, *arguments[:1]):
            _check_closed(place)
        return action(path, *arguments, **options)

    return act


def _check_closed(path):
    try:
        wanted = os.lstat(path)
    except (OSError, TypeError, ValueError):
        return
    for descriptor in os.listdir("/proc/self/fd"):
        try:
            result = os.fstat(int(descriptor))
        except OSError:
            continue
        if os.path.samestat(result, wanted):
            raise PermissionError(13, "the file is open", str(path))


def install():
    """Make this Python one of the other system."""
    windows = types.SimpleNamespace(LockFile=_Function(_lock_file))
    ctypes.WinDLL = lambda *_, **__: windows
    ctypes.get_last_error = lambda: 33
    builtins.__import__ = _without_posix
    for name in REMOVED:
        if hasattr(os, name):
            delattr(os, name)
    for name in ("rename", "replace", "remove", "unlink"):
        setattr(os, name, _unless_open(getattr(os, name)))


class _Function:
    """A function of a library, whose types can be set."""

    def __init__(self, function):
        self._function = function

    def __call__(self, *arguments):
        return self._function(*arguments)
