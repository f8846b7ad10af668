"""Reopen a log for writing, to close it after its writer was killed or to continue it from a checkpoint."""

import os
import shutil
from collections.abc import Mapping
from pathlib import Path

import h5py

from idealgas.errors import UserError
from idealgas.files import LOG, error_number, storage_error, written
from idealgas.log.errors import DamageError, LogError, reason
from idealgas.log.hdf5.commit import Commit
from idealgas.log.hdf5.superblock import ReadableFile
from idealgas.log.hdf5.table_writer import TableWriter, commit_tables, open_tables
from idealgas.log.hdf5.writable_file import ChangedError, WritableFile
from idealgas.log.reader import Log, open_log


def recover(path: str | os.PathLike[str], output: str | os.PathLike[str] | None = None, force: bool = False) -> int:
    """Close a log that was left open, so that any HDF5 program can open it. A closed log remains unchanged.

    Args:
        path: path of the log.
        output: path of a copy; if given, the copy is closed instead of the log itself.
        force: whether the copy may overwrite an existing log.

    Returns:
        Number of event rows.

    Raises:
        LogError: if the log is damaged.
        OutputError: if the log is being written, or if the copy cannot be written.
    """
    path = Path(path)
    with open_log(path) as log:
        rows, keep = len(log), _committed(log) if log.unclosed else None
        if output is not None:
            with written(output, LOG, force, [path]) as copy:
                shutil.copyfile(path, copy)
                _close(copy, keep)
            return rows
    _close(path, keep, log.commit)
    return rows


def reopen(
    path: str | os.PathLike[str], checkpoint: int | None, commit: Commit | None = None
) -> tuple[WritableFile, dict[str, TableWriter], int]:
    """Open a log for appending after one of its checkpoints, or after its start.

    Args:
        path: path of the log.
        checkpoint: index of the checkpoint; None for the start.
        commit: newest commit that the log must have; None if any commit is accepted.

    Returns:
        The file, the writers of its tables by name, and the sequence number of its last commit.

    Raises:
        LogError: if the log has no such checkpoint, is damaged or has another commit.
        OutputError: if the log is being written.
    """
    path = Path(path)
    with open_log(path) as log:
        rows = {"runs": log.commit.rows["runs"]}
        if checkpoint is not None:
            try:
                index = range(len(log.checkpoints))[checkpoint]
            except IndexError:
                raise LogError(f"{path}: no checkpoint {checkpoint} among {len(log.checkpoints)}") from None
            time, row = log.checkpoints.times[index], log.checkpoints.rows[index]
            rows |= {"events": int(row), "checkpoints": index + 1}
            rows["particles"] = int(log.snapshot_times.searchsorted(time, "right"))
            rows["changes"] = sum(change.time <= time for change in log.changes)
            times = log.observables.times  # if two samples have the same time, the second was taken at the end of a run
            rows["observables"] = int(min(times.searchsorted(time) + 1, times.searchsorted(time, "right")))
        keep = {table: rows.get(table, 0) for table in log.commit.rows}
        _check_appendable(log, keep)
    return open_after(path, keep, commit or log.commit)


def _committed(log: Log) -> dict[str, int]:
    """Return the number of valid rows in each table, after which the log can be continued."""
    rows = {"events": len(log), "checkpoints": len(log.checkpoints)}
    keep = {table: rows.get(table, stored) for table, stored in log.commit.rows.items()}
    _check_appendable(log, keep)
    return keep


def _close(path: Path, keep: Mapping[str, int] | None, commit: Commit | None = None) -> None:
    """Close a log after the first `keep` rows of each table; do nothing if `keep` is None, for a log already closed."""
    if keep is not None:
        open_after(path, keep, commit)[0].close()


def _check_appendable(log: Log, keep: Mapping[str, int]) -> None:
    """Raise DamageError if a log cannot be continued after these rows; to be called before the log is changed."""
    if log.live:
        return  # reopening it will be refused, and its writer may be changing the same bytes
    try:
        with ReadableFile(log.path) as source, h5py.File(source, "r") as file:
            open_tables(file, Commit.read(file), keep)
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise DamageError(log.path, reason(error)) from error


def open_after(
    path: Path, keep: Mapping[str, int], commit: Commit | None = None
) -> tuple[WritableFile, dict[str, TableWriter], int]:
    """Open a log for appending after the first `keep` rows of each table, and remove later rows.

    The commit record is written first, so that the log is valid at every moment. If the newest commit of the log
    differs from `commit`, another run has continued or replaced the log since it was read; the log then remains
    unchanged, and LogError is raised.
    """
    try:
        opened = WritableFile(path, commit)
    except ChangedError:
        raise LogError(f"{path}: was changed by another run while it was being read") from None
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise _failure(path, error) from error
    try:
        newest = Commit.read(opened.file)
        tables = open_tables(opened.file, newest, keep)
        opened.file.swmr_mode = True
        for step in (1, 2):
            commit_tables(opened.file, tables, newest.sequence + step)
        for table in tables.values():
            table.trim()
        opened.file.flush()
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        opened.abandon()
        raise _failure(path, error) from error
    return opened, tables, newest.sequence + 2


def _failure(path: Path, error: Exception) -> UserError:
    """Return the error to raise for a log that cannot be opened for appending.

    An error with an error number comes from the operating system; any other error means that the file is damaged.
    """
    return DamageError(path, reason(error)) if error_number(error) is None else storage_error(path, error)
