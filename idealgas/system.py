"""Differences between operating systems, in one place: locks, files that are open, folders of users.

Everything else in the package uses only what Python offers on all systems.
"""

import ctypes
import errno
import os
import stat
import struct
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

Result = TypeVar("Result")

try:
    import fcntl
except ImportError:
    fcntl = None  # type: ignore[assignment]
try:
    import msvcrt
except ImportError:
    msvcrt = None  # type: ignore[assignment]

_NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOTSUP, errno.EINVAL}
"""Numbers of the errors of file systems and kernels without locks."""

MOVES_OPEN_FILES = os.name != "nt"
"""Whether a file that is open can be moved and replaced."""

STDIN = "/dev/stdin"
"""Path of the standard input, also on systems without such a file."""

WITHOUT_WAITING = getattr(os, "O_NONBLOCK", 0)
"""Flag of `os.open` with which opening a FIFO does not wait."""

_FLOCK = "hhqqi0q"
"""Linux's `struct flock`: type, whence, start, length, process."""

_FAR = 1 << 30
"""High 32 bits of the byte that is locked on Windows: the lock also keeps others from reading, so it lies far away."""


def lock(descriptor: int) -> None:
    """Lock a file, open for writing, until it is closed.

    The lock belongs to the open file, not to the process: opening and closing the same file elsewhere in the process
    does not free it. It is advisory.

    Raises:
        BlockingIOError: if another open file has the lock, in this process or in another one.
        OSError: with number ENOLCK, if the file system has no locks.
    """
    _locking(lambda: _lock(descriptor))


def has_other_lock(descriptor: int) -> bool:
    """Whether another open file has the lock of a file, open for reading; on some systems this takes it for a moment.

    Raises:
        OSError: as `lock`.
    """
    try:
        return _locking(lambda: _test(descriptor))
    except BlockingIOError:
        return True


def _locking(action: Callable[[], Result]) -> Result:
    try:
        return action()
    except OSError as error:
        if error.errno in _NO_LOCKS:
            raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK)) from error
        raise


if hasattr(fcntl, "F_OFD_SETLK"):  # Linux

    def _lock(descriptor: int) -> None:
        fcntl.fcntl(descriptor, fcntl.F_OFD_SETLK, _exclusive())

    def _test(descriptor: int) -> bool:
        found = fcntl.fcntl(descriptor, fcntl.F_OFD_GETLK, _exclusive())
        return struct.unpack(_FLOCK, found)[0] != fcntl.F_UNLCK

    def _exclusive() -> bytes:
        return struct.pack(_FLOCK, fcntl.F_WRLCK, os.SEEK_SET, 0, 0, 0)

elif fcntl:

    def _lock(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def _test(descriptor: int) -> bool:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
        return False

elif msvcrt:
    _kernel: Any = ctypes.WinDLL("kernel32", use_last_error=True)  # type: ignore[attr-defined]
    _kernel.LockFile.argtypes = [ctypes.c_void_p, *[ctypes.c_uint32] * 4]  # handle; offset and length: low, high bits

    def _lock(descriptor: int) -> None:
        """Lock one byte; `msvcrt.locking` takes only the low bits of the offset, and would lie within long files."""
        if not _kernel.LockFile(msvcrt.get_osfhandle(descriptor), 0, _FAR, 1, 0):  # type: ignore[attr-defined]
            locked = ctypes.get_last_error() == 33  # type: ignore[attr-defined]
            number = errno.EAGAIN if locked else errno.ENOLCK
            raise OSError(number, os.strerror(number))

    def _test(descriptor: int) -> bool:
        _lock(descriptor)
        return False

else:

    def _lock(descriptor: int) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    def _test(descriptor: int) -> bool:
        return False


def sync_folder(folder: Path) -> None:
    """Wait until the names in a folder are on the disk; Windows cannot, and writes them in order."""
    if os.name != "nt":
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def move_to_free_name(part: Path, place: Path) -> None:
    """Move a file to a name that is free; FileExistsError if it is not.

    Windows does so itself. A file system without links has no way to do so atomically.
    """
    if os.name == "nt":
        part.rename(place)
        return
    try:
        os.link(part, place)
    except FileExistsError:
        raise
    except (OSError, AttributeError):
        if place.exists():
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from None
        part.replace(place)
    else:
        part.unlink()


def cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def free_unused_memory() -> None:
    """Return freed memory to the system: glibc keeps much of what placing a large gas and compiling took."""
    if sys.platform == "linux" and hasattr(c_library := ctypes.CDLL(None), "malloc_trim"):
        c_library.malloc_trim(0)


def cache_home() -> Path | None:
    """Folder for caches of the user; None for a user without a home."""
    if sys.platform == "win32":
        named, usual = "LOCALAPPDATA", "~/AppData/Local"
    else:
        named, usual = "XDG_CACHE_HOME", "~/Library/Caches" if sys.platform == "darwin" else "~/.cache"
    found = (Path(os.environ.get(named, "")), Path(os.path.expanduser(usual)))
    return next((path for path in found if path.is_absolute()), None)


def user_number() -> int | None:
    """Number of the user of this process; None on Windows, where the folders of a user are private."""
    return os.geteuid() if hasattr(os, "geteuid") else None


def make_private(folder: Path) -> bool:
    """Make a folder unless it exists; returns whether only the user of this process and root can write or replace it.

    Nothing is made in a folder of another user.
    """
    user = user_number()
    if user is not None:
        above = [path.stat() for path in folder.resolve().parents if path.exists()]
        if any(path.st_uid not in (0, user) or path.st_mode & (0o002 | stat.S_ISVTX) == 0o002 for path in above):
            return False
    for path in (folder.parent, folder):
        path.mkdir(0o700, parents=True, exist_ok=True)
    own = folder.lstat()
    return user is None or (stat.S_ISDIR(own.st_mode) and own.st_uid == user and not own.st_mode & 0o022)
