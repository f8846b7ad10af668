"""Output files, which are checked before writing and appear under their names only when they are complete."""

import errno
import os
import re
import secrets
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from idealgas import system
from idealgas.errors import OutputError
from idealgas.locks import WriteLock, is_locked, open_regular

LOG = "log"
"""Kind of a log file; other kinds are named by their extensions."""

HEAD = 4096  # number of bytes at the start of a file from which its type is recognised

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
    ".ipynb": rb'\{\s*"cells": \[',
    ".json": rb'\{\s*"(title|period)"',
    ".mp4": rb"....ftyp",
    ".parquet": rb"PAR1",
    ".pdf": rb"%PDF-",
    ".png": rb"\x89PNG\r\n\x1a\n",
    ".svg": rb"<\?xml.*<svg",
    ".toml": rb"# sweep of \d+ points by idealgas\n",
    "results.csv": rb"",  # a sweep renames a table that it did not write
    "scene": rb"#:schema scene",
    "scene.schema.json": rb'\{\s*"\$defs"',
}
"""Patterns of the first bytes of files that this program writes, by kind."""

IN_USE = "another run is writing this file"
NO_LOCKS = (
    "this file system does not support locks; set HDF5_USE_FILE_LOCKING=FALSE and let only one process write the file"
)

Name = str | os.PathLike[str]


def check_output(path: Name, kind: str, force: bool = False, inputs: Iterable[Name] = ()) -> None:
    """Check that a file can be written.

    An existing file is overwritten only with `force`, and only if it is empty or of the same kind, so that a mistyped
    name does not destroy other files.

    Args:
        path: path of the file.
        kind: kind of the file.
        force: whether an existing file of this kind may be overwritten.
        inputs: files that must not be overwritten.

    Raises:
        OutputError: if the file cannot be written.
    """
    path = Path(path)
    try:
        existing = _stat(path)
        place = path.resolve()
        if existing is None and not place.parent.is_dir():
            raise OutputError(f"{path}: no folder {path.parent}")
        if existing is not None:
            _check_replaceable(path, existing, kind, force, inputs)
        if existing is not None and is_locked(place):
            raise OutputError(f"{path}: {IN_USE}")
        if existing is not None:
            open_regular(place, "r+b").close()
        _check_folder(place, needs_lock=kind == LOG)
    except OSError as error:
        raise storage_error(path, error) from error


def _check_folder(place: Path, needs_lock: bool) -> None:
    """Raise OSError with the system's reason if a file cannot be created or locked in a folder."""
    part = beside(place)
    part.touch(exist_ok=False)
    try:
        WriteLock(part, needs_lock).close()
    finally:
        part.unlink()


def _check_replaceable(path: Path, existing: os.stat_result, kind: str, force: bool, inputs: Iterable[Name]) -> None:
    if stat.S_ISDIR(existing.st_mode):
        raise OutputError(f"{path}: is a folder")
    if not stat.S_ISREG(existing.st_mode):
        raise OutputError(f"{path}: is not a regular file")
    if any(os.path.samestat(existing, status) for status in map(_stat, inputs) if status):
        raise OutputError(f"{path}: output would overwrite the input")
    if not force:
        raise OutputError(f"{path}: already exists (use force=True to overwrite)")
    if existing.st_size and not is_of_kind(path, kind):
        what = "log" if kind == LOG else f"{kind} file"
        raise OutputError(f"{path}: is not a {what} of idealgas and will not be overwritten")


def is_of_kind(path: Path, kind: str) -> bool:
    """Return whether a file begins like files of this kind that this program writes."""
    with open_regular(path) as file:
        return bool(re.match(_BEGINNINGS[kind], file.read(HEAD), re.DOTALL))


def describe_file_type(head: bytes) -> str:
    """Return the type of a file, recognised by its first bytes, with the command that reads such files."""
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
    """Check an output with `check_output`, then write it as with `replacing`. Raises OutputError."""
    check_output(path, kind, force, inputs)
    with replacing(Path(path), force) as part:
        yield part


@contextmanager
def replacing(path: Path, force: bool = True) -> Iterator[Path]:
    """Yield a temporary path for writing; afterwards, the complete file is moved to `path`.

    Raises:
        OutputError: if the file cannot be written; the temporary file is removed.
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
    """Return a unique hidden path in the folder of a file; for a symbolic link, in the folder of the link's target."""
    place = path.resolve()
    return place.with_name(f".{place.name}.{secrets.token_hex(4)}")


def temporaries(folder: Path) -> Iterator[Path]:
    """Yield the files in a folder whose paths were created by `beside`."""
    for path in folder.iterdir():
        if re.fullmatch(r"\..+\.[0-9a-f]{8}", path.name):
            yield path


def give_name(part: Path, path: Path, force: bool, fsync: bool = False) -> None:
    """Move a complete file to its final path, atomically.

    An existing file is overwritten only with `force`, and never while a process is writing it.
    """
    place = path.resolve()
    while not _named(part, place, force):
        pass  # the existing file has since been removed or replaced
    if fsync:
        system.sync_folder(place.parent)


def _named(part: Path, place: Path, force: bool) -> bool:
    try:
        system.move_to_free_name(part, place)
        return True
    except FileExistsError:
        if not force:
            raise
    try:
        with WriteLock(place, needed=False) as old:
            if not old.is_of(place):
                return False
            if not system.MOVES_OPEN_FILES:
                old.close()  # if a writer opens the file now, it cannot be replaced
            part.replace(place)
    except FileNotFoundError:
        if not part.exists():
            raise
        return False
    return True


def error_number(error: Exception) -> int | None:
    """Return the number of the system error that caused an error; None if there is none.

    HDF5 errors contain the number only in their text.
    """
    number = error.errno if isinstance(error, OSError) else None
    match = re.search(r"errno = (\d+)", str(error))
    return int(match[1]) if number is None and match else number


def storage_error(path: Path, error: Exception) -> OutputError:
    """Return the OutputError for a file that could not be written."""
    number = error_number(error)
    if number == errno.EEXIST:
        return OutputError(f"{path}: already exists (use force=True to overwrite)")
    if number in (errno.EAGAIN, errno.EWOULDBLOCK):
        return OutputError(f"{path}: {IN_USE}")
    if number == errno.ENOLCK:
        return OutputError(f"{path}: cannot be written: {NO_LOCKS}", exit_code=1)
    reason = os.strerror(number) if number else str(error).splitlines()[0]
    return OutputError(f"{path}: cannot be written: {reason}", exit_code=1)
