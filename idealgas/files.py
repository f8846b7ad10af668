"""Output files: checks before writing, complete files appear under their names at once, one writer per file."""

import errno
import fcntl
import os
import re
import secrets
import stat
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from idealgas.errors import OutputError

LOG = "log"
"""Kind of a log; the other kinds are the endings of their files."""

HEAD = 4096  # bytes at the start of a file from which its type is recognised

_HTML = rb'<!doctype html>.*<meta name="generator" content="idealgas'
_HDF5 = rb"\x89HDF\r\n\x1a\n"
_BEGINNINGS = {
    LOG: _HDF5 + rb".*idealgas log",
    ".csv": rb'"time","disc"|case,|precision,',
    ".extxyz": rb"\d+\nLattice=",
    ".gif": rb"GIF8[79]a",
    ".gsd": rb"\xdf\x65" * 4,
    ".h5md": _HDF5,
    ".htm": _HTML,
    ".html": _HTML,
    ".json": rb'\{\s*"(title|period)"',
    ".mp4": rb"....ftyp",
    ".parquet": rb"PAR1",
    ".pdf": rb"%PDF-",
    ".png": rb"\x89PNG\r\n\x1a\n",
    ".svg": rb"<\?xml.*<svg",
    ".toml": rb"# sweep of \d+ points by idealgas\n",
    "results.csv": rb"point,replicate,seed,",
    "scene": rb"#:schema scene",
    "scene.schema.json": rb'\{\s*"\$defs"',
}
"""First bytes of the files of each kind that this program writes."""

TIMEOUT = 0.5
"""Time for which a writer waits for a lock, as readers hold it for a moment in `is_locked`, s."""

Name = str | os.PathLike[str]


def check_output(path: Name, kind: str, force: bool = False, inputs: Iterable[Name] = ()) -> None:
    """Raise OutputError if a file of a kind cannot be written.

    An existing file is only overwritten with `force`, and only if it is empty or of the same kind, so that a typing
    error does not destroy other files. inputs: files that must not be overwritten.
    """
    path = Path(path)
    try:
        found = _stat(path)
        place = path.resolve()
        if found is None and not place.parent.is_dir():
            raise OutputError(f"{path}: no folder {path.parent}")
        if found is not None:
            _check_replaceable(path, found, kind, force, inputs)
        for needed in (place.parent, *([place] if found else [])):
            if not os.access(needed, os.R_OK | os.W_OK):
                raise OutputError(f"{path}: cannot be written: {os.strerror(errno.EACCES)}", exit_code=1)
        if found is not None and is_locked(place):
            raise OutputError(f"{path}: another process has this file open")
    except OSError as error:
        raise storage_error(path, error) from error


def _check_replaceable(path: Path, found: os.stat_result, kind: str, force: bool, inputs: Iterable[Name]) -> None:
    if stat.S_ISDIR(found.st_mode):
        raise OutputError(f"{path}: is a folder")
    if not stat.S_ISREG(found.st_mode):
        raise OutputError(f"{path}: is not a regular file")
    if any(os.path.samestat(found, there) for there in map(_stat, inputs) if there):
        raise OutputError(f"{path}: output would overwrite the input")
    if not force:
        raise OutputError(f"{path}: already exists (use force=True to overwrite)")
    if found.st_size and not is_of_kind(path, kind):
        what = "log" if kind == LOG else f"{kind} file"
        raise OutputError(f"{path}: is not a {what} of idealgas, so force=True does not overwrite it")


def is_of_kind(path: Path, kind: str) -> bool:
    """Whether a file begins like those of a kind that this program writes."""
    with open_regular(path) as file:
        return bool(re.match(_BEGINNINGS[kind], file.read(HEAD), re.DOTALL))


def describe_file_type(head: bytes) -> str:
    """Type of a file by its first bytes, and the command that reads such files."""
    if re.match(_HDF5, head):
        return "an HDF5 file (`idealgas info` reads logs)"
    if b"\0" in head:
        return "a binary file"
    return "a text (`idealgas check` reads scenes)" if head else "empty"


def _stat(path: Name) -> os.stat_result | None:
    with suppress(FileNotFoundError, NotADirectoryError):
        return os.stat(path)
    return None


@contextmanager
def written(path: Name, kind: str, force: bool = False, inputs: Iterable[Name] = ()) -> Iterator[Path]:
    """Check an output with `check_output`, then write it as in `replacing`. Raises OutputError."""
    check_output(path, kind, force, inputs)
    with replacing(Path(path), force) as part:
        yield part


@contextmanager
def replacing(path: Path, force: bool = True) -> Iterator[Path]:
    """Yield a temporary path for writing; the complete file is then moved to `path`.

    Raises OutputError on failure, after which no temporary file is left.
    """
    part = beside(path)
    try:
        yield part
        give_name(part, path, force)
    except OSError as error:
        raise storage_error(path, error) from error
    finally:
        with suppress(OSError):
            part.unlink()


def beside(path: Path) -> Path:
    """Unique hidden path in the folder of a file; of a symbolic link, in the folder of its target."""
    place = path.resolve()
    return place.with_name(f".{place.name}.{secrets.token_hex(4)}")


def give_name(part: Path, path: Path, force: bool, fsync: bool = False) -> None:
    """Move a complete file to its final path, atomically.

    Existing files are only overwritten with `force`, and never if another process is writing them.
    """
    place = path.resolve()
    while not _named(part, place, force):
        pass  # the existing file was removed or replaced meanwhile
    if fsync:
        folder = os.open(place.parent, os.O_RDONLY)
        os.fsync(folder)
        os.close(folder)


def _named(part: Path, place: Path, force: bool) -> bool:
    try:
        os.link(part, place)
    except FileExistsError:
        if not force:
            raise
    except OSError:  # a file system without links
        if not place.exists():
            part.replace(place)
            return True
        if not force:
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from None
    else:
        part.unlink()
        return True
    try:
        with place.open("r+b") as old:
            lock(old)
            if not os.path.samestat(os.fstat(old.fileno()), place.stat()):
                return False
            part.replace(place)
    except FileNotFoundError:
        if not part.exists():
            raise
        return False
    return True


def storage_error(path: Path, error: Exception) -> OutputError:
    """Error for a file that could not be written; HDF5 has the number of the system's error only in its text."""
    number = error.errno if isinstance(error, OSError) else None
    if number is None and (found := re.search(r"errno = (\d+)", str(error))):
        number = int(found[1])
    if number == errno.EEXIST:
        return OutputError(f"{path}: already exists (use force=True to overwrite)")
    if number in (errno.EAGAIN, errno.EWOULDBLOCK):
        return OutputError(f"{path}: another process has this file open")
    reason = os.strerror(number) if number else str(error).splitlines()[0]
    return OutputError(f"{path}: cannot be written: {reason}", exit_code=1)


def lock(file: int | IO) -> None:
    """Lock a file as its only writer until it is closed. Raises OSError if another process has locked it.

    HDF5 releases its own lock in SWMR mode. This one is advisory.
    """
    deadline = time.monotonic() + TIMEOUT
    while True:
        try:
            return fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.001)


def is_locked(path: Path) -> bool:
    """Whether another process has locked a file with `lock`."""
    try:
        with open_regular(path) as file:
            fcntl.lockf(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError as error:
        return isinstance(error, BlockingIOError)
    return False


def open_regular(path: Path) -> IO[bytes]:
    """Open a regular file for reading, unbuffered. Raises OSError for anything else."""
    return open(path, "rb", buffering=0, opener=regular)


def regular(path: str, flags: int) -> int:
    """Opener for `open`, of regular files only. Opening a device may change it, and opening a FIFO waits."""
    _check_regular(os.stat(path))
    descriptor = os.open(path, flags | os.O_NONBLOCK)
    try:
        _check_regular(os.fstat(descriptor))  # it may have been replaced meanwhile
    except OSError:
        os.close(descriptor)
        raise
    return descriptor


def _check_regular(found: os.stat_result) -> None:
    if stat.S_ISDIR(found.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(found.st_mode):
        raise OSError(errno.EINVAL, "not a regular file")
