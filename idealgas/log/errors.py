"""What goes wrong with a log file, said in one line."""

import errno
import os
import re
from pathlib import Path

from idealgas.errors import UserError
from idealgas.log.hdf5.superblock import is_locked


class LogError(UserError):
    """A log cannot be read or made (exit code 2), or storing fails (exit code 1)."""

    def __init__(self, message: str, exit_code: int = 2) -> None:
        super().__init__(message)
        self.exit_code = exit_code


def storage_error(path: Path, error: Exception) -> LogError:
    """Why a file could not be written; HDF5 tells the system's reason only within its text."""
    number = error.errno if isinstance(error, OSError) else None
    if number is None and (found := re.search(r"errno = (\d+)", str(error))):
        number = int(found[1])
    if number == errno.EEXIST:
        return LogError(f"{path}: exists already (--force replaces it)")
    if number in (errno.EAGAIN, errno.EWOULDBLOCK):
        return LogError(f"{path}: another process has this file open")
    reason = os.strerror(number) if number else str(error).splitlines()[0]
    return LogError(f"{path}: cannot be written: {reason}", exit_code=1)


def give_name(part: Path, path: Path, force: bool, fsync: bool) -> None:
    """Let a file that is whole appear under its name, in one step, and without `force` never in place of another."""
    try:
        if force:
            part.replace(path)
        else:
            os.link(part, path)
            part.unlink()
    except FileExistsError:
        raise
    except OSError:  # a file system without links
        if path.exists() and not force:
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from None
        part.replace(path)
    if fsync:
        folder = os.open(path.parent, os.O_RDONLY)
        os.fsync(folder)
        os.close(folder)


def check_output(path: str | os.PathLike[str], force: bool = False) -> None:
    """Raise LogError if a log cannot be made here: it exists (unless `force`), or its folder cannot be written to."""
    path = Path(path)
    if path.is_dir():
        raise LogError(f"{path}: is a folder")
    if path.exists() and not force:
        raise LogError(f"{path}: exists already (--force replaces it)")
    if not path.parent.is_dir():
        raise LogError(f"{path}: no folder {path.parent}")
    if not os.access(path if path.exists() else path.parent, os.R_OK | os.W_OK):
        raise LogError(f"{path}: cannot be written: {os.strerror(errno.EACCES)}", exit_code=1)
    if path.exists() and is_locked(path):
        raise LogError(f"{path}: another process has this file open")
