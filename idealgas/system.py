"""Functions that differ between operating systems: locks, open files, user folders.

The rest of the package uses only what Python offers on all systems.
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
"""Error numbers that file systems and kernels without support for locks report."""

MOVES_OPEN_FILES = os.name != "nt"
"""Whether an open file can be moved and replaced."""

STDIN = "/dev/stdin"
"""Path that stands for the standard input, even on systems without such a file."""

WITHOUT_WAITING = getattr(os, "O_NONBLOCK", 0)
"""Flag for `os.open` that prevents it from waiting when it opens a FIFO."""

_FLOCK = "hhqqi0q"
"""Format of Linux's `struct flock`: type, whence, start, length, process."""

_FAR = 1 << 30
"""High 32 bits of the position of the byte that is locked on Windows.

The byte lies far beyond the end of any file, because other processes cannot read a locked byte.
"""


def lock(descriptor: int) -> None:
    """Lock a file, which must be open for writing, until it is closed. The lock is advisory.

    The lock belongs to the open file, not to the process: opening and closing the same file elsewhere in the process
    does not release it.

    Raises:
        BlockingIOError: if another open file in this or another process holds the lock.
        OSError: with errno ENOLCK, if the file system does not support locks.
    """
    _locking(lambda: _lock(descriptor))


def has_other_lock(descriptor: int) -> bool:
    """Return whether another open file holds the lock on a file, which must be open for reading.

    On some systems this check itself holds the lock for a moment.

    Raises:
        OSError: as for `lock`.
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
        conflict = fcntl.fcntl(descriptor, fcntl.F_OFD_GETLK, _exclusive())
        return struct.unpack(_FLOCK, conflict)[0] != fcntl.F_UNLCK

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
        """Lock a byte. `msvcrt.locking` accepts only low offsets, which lie within long files."""
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
    """Wait until the names in a folder are on the disk.

    On Windows, which writes names in order, this does nothing.
    """
    if os.name != "nt":
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def move_to_free_name(part: Path, place: Path) -> None:
    """Move a file to a new name, without overwriting an existing file.

    The move is atomic, except on a file system that does not support hard links.

    Raises:
        FileExistsError: if a file with this name exists.
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
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def free_unused_memory() -> None:
    """Return freed memory to the system.

    glibc would keep much of the memory that was used for placing a gas and for compiling.
    """
    if sys.platform == "linux" and hasattr(c_library := ctypes.CDLL(None), "malloc_trim"):
        c_library.malloc_trim(0)


def cache_home() -> Path | None:
    """Return the folder for the user's caches; None for a user without a home folder."""
    if sys.platform == "win32":
        named, usual = "LOCALAPPDATA", "~/AppData/Local"
    else:
        named, usual = "XDG_CACHE_HOME", "~/Library/Caches" if sys.platform == "darwin" else "~/.cache"
    candidates = (Path(os.environ.get(named, "")), Path(os.path.expanduser(usual)))
    return next((path for path in candidates if path.is_absolute()), None)


def user_number() -> int | None:
    """Return the numeric id of the user of this process; None on Windows, where user folders are private."""
    return os.geteuid() if hasattr(os, "geteuid") else None


def make_private(folder: Path) -> bool:
    """Create a folder unless it exists; return whether only root and the user of this process can change it.

    The folder is not created inside a folder that another user can change.
    """
    user = user_number()
    if user is not None:
        above = [path.stat() for path in folder.resolve().parents if path.exists()]
        if any(path.st_uid not in (0, user) or path.st_mode & (0o002 | stat.S_ISVTX) == 0o002 for path in above):
            return False
    for path in (folder.parent, folder):
        path.mkdir(0o700, parents=True, exist_ok=True)
    status = folder.lstat()
    return user is None or (stat.S_ISDIR(status.st_mode) and status.st_uid == user and not status.st_mode & 0o022)
