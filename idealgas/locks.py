"""Open regular files, with only one writer per file at a time.

The writer holds a lock that all processes respect, and is also registered in its own process.
"""

import errno
import os
import stat
import threading
import time
from pathlib import Path
from typing import IO, Self

from idealgas import system

TIMEOUT = 0.5
"""Time for which a writer waits for a lock, because on some systems readers hold it for a moment, s."""

_held: dict[tuple[int, int], "WriteLock"] = {}
_guard = threading.Lock()


class WriteLock:
    """The exclusive right to write a file, held until `close`.

    Attributes:
        descriptor: descriptor of the file, open for reading and writing.
    """

    def __init__(self, path: Path, needed: bool = True) -> None:
        """Lock a file.

        Args:
            path: path of the file.
            needed: whether the file system must support locks, unless the user has disabled file locking.

        Raises:
            BlockingIOError: if this or another process is writing the file.
            OSError: if the file cannot be opened for writing, or, with errno ENOLCK, if its file system does not
                support locks.
        """
        self.descriptor = regular(path, os.O_RDWR)
        self._key = _key(self.descriptor)
        with _guard:
            if _held.setdefault(self._key, self) is not self:
                os.close(self.descriptor)
                raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))
        try:
            _lock(self.descriptor, needed and not _locking_disabled())
        except OSError:
            self.close()
            raise

    def is_of(self, path: Path) -> bool:
        """Return whether a path still refers to the locked file."""
        return os.path.samestat(os.fstat(self.descriptor), os.stat(path))

    def close(self) -> None:
        """Release the lock."""
        with _guard:
            if _held.get(self._key) is self:
                del _held[self._key]
                os.close(self.descriptor)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _key(descriptor: int) -> tuple[int, int]:
    status = os.fstat(descriptor)
    return status.st_dev, status.st_ino


def _locking_disabled() -> bool:
    """Return whether the user has disabled file locking, with the same environment variable as for HDF5."""
    return os.environ.get("HDF5_USE_FILE_LOCKING", "").upper() in ("FALSE", "0", "BEST_EFFORT")


def _lock(descriptor: int, needed: bool) -> None:
    deadline = time.monotonic() + TIMEOUT
    while True:
        try:
            return system.lock(descriptor)
        except BlockingIOError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.001)
        except OSError as error:
            if needed or error.errno != errno.ENOLCK:
                raise
            return None


def is_locked(path: Path) -> bool:
    """Return whether this or another process is writing a file."""
    try:
        with open_regular(path) as file:
            return _key(file.fileno()) in _held or system.has_other_lock(file.fileno())
    except OSError:
        return False


def _leave_to_parent() -> None:
    """Close the locked files in a forked child, which would otherwise keep them locked after its parent has ended."""
    global _guard
    _guard = threading.Lock()
    for lock in tuple(_held.values()):
        lock.close()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_leave_to_parent)


def open_regular(path: Path, mode: str = "rb") -> IO[bytes]:
    """Open a regular file without buffering. Raises OSError if it is not a regular file."""
    return open(path, mode, buffering=0, opener=regular)


def regular(path: str | Path, flags: int) -> int:
    """Open a regular file; for use as the `opener` of `open`.

    Other files are rejected before they are opened, because opening a device may change its state, and opening a FIFO
    waits.
    """
    _check_regular(os.stat(path))
    descriptor = os.open(path, flags | system.WITHOUT_WAITING)
    try:
        _check_regular(os.fstat(descriptor))  # the file may have been replaced in the meantime
    except OSError:
        os.close(descriptor)
        raise
    return descriptor


def _check_regular(status: os.stat_result) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "not a regular file")
