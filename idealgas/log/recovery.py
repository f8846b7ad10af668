"""Opening a log for writing again: after a crash, or to continue it from a checkpoint."""

import os
import shutil
from collections.abc import Mapping
from pathlib import Path

import h5py

from idealgas.files import LOG, lock, storage_error, written
from idealgas.log.errors import DamageError, LogError, reason
from idealgas.log.hdf5.commit import Commit
from idealgas.log.hdf5.superblock import ClearedFile, abandon, clear_consistency_flags, has_consistency_flags
from idealgas.log.hdf5.table_writer import TableWriter, commit_tables, open_tables
from idealgas.log.reader import Log, open_log
from idealgas.log.schema import FILE_OPTIONS


def recover(path: str | os.PathLike[str], output: str | os.PathLike[str] | None = None, force: bool = False) -> int:
    """Close a log that was not closed, in place or as a copy `output`; returns the event rows kept.

    A log that was closed stays as it is. Another log under the name of the copy is replaced only with `force`. Raises
    LogError if the file is damaged, OutputError if its writer lives or the copy cannot be written.
    """
    path = Path(path)
    if output is None:
        return _recover(path)
    with open_log(path) as log, written(output, LOG, force, [path]) as copy:
        _kept(log)  # what is wrong is said of the log, not of its copy
        shutil.copyfile(path, copy)
        return _recover(copy)


def _recover(path: Path) -> int:
    with open_log(path) as log:
        rows, unclosed, keep = len(log), log.unclosed, _kept(log)
    if unclosed:
        _cut(path, keep)[0].close()
    return rows


def _kept(log: Log) -> dict[str, int]:
    """Rows of each table that a log holds."""
    held = {"events": len(log), "checkpoints": len(log.checkpoints)}
    keep = {table: held.get(table, stored) for table, stored in log.commit.rows.items()}
    if log.unclosed:
        _check(log, keep)
    return keep


def _check(log: Log, keep: Mapping[str, int]) -> None:
    """Raise DamageError where a log cannot be gone on with after these rows, before a byte of it is changed."""
    if log.live:
        return  # it cannot be gone on with anyway, and its writer may be at work on these very bytes
    try:
        with h5py.File(ClearedFile(log.path) if log.unclosed else log.path, "r") as file:
            open_tables(file, Commit.read(file), keep)
    except (OSError, RuntimeError, ValueError, KeyError) as error:
        raise DamageError(log.path, reason(error)) from error


def reopen(path: str | os.PathLike[str], checkpoint: int | None) -> tuple[h5py.File, dict[str, TableWriter], int]:
    """A log to resume after one of its checkpoints, or from its start: file, tables, number of its last commit."""
    path = Path(path)
    with open_log(path) as log:
        held = {"runs": log.commit.rows["runs"]}
        if checkpoint is not None:
            try:
                index = range(len(log.checkpoints))[checkpoint]
            except IndexError:
                raise LogError(f"{path}: no checkpoint {checkpoint} among {len(log.checkpoints)}") from None
            time, row = log.checkpoints.times[index], log.checkpoints.rows[index]
            held |= {"events": int(row), "checkpoints": index + 1}
            held["particles"] = int(log.snapshot_times.searchsorted(time, "right"))
            for times, _ in log.observables.values():  # the first sample of an instant is a checkpoint's, not an end's
                first, after = (int(times.searchsorted(time, side)) for side in ("left", "right"))  # type: ignore[call-overload]
                held["observables"] = min(first + 1, after)
        keep = {table: held.get(table, 0) for table in log.commit.rows}
        _check(log, keep)
    return _cut(path, keep)


def _cut(path: Path, keep: Mapping[str, int]) -> tuple[h5py.File, dict[str, TableWriter], int]:
    """Open for appending after the first `keep` rows of each table; what came after them is gone.

    The record says so first: at any moment from then on, the rows kept are there.
    """
    try:
        if has_consistency_flags(path):
            clear_consistency_flags(path)
        file = h5py.File(path, "r+", **FILE_OPTIONS)
    except (OSError, ValueError) as error:
        raise storage_error(path, error) from error
    try:
        lock(file.id.get_vfd_handle())
        commit = Commit.read(file)
        tables = open_tables(file, commit, keep)
        file.swmr_mode = True
        for sequence in (1, 2):
            commit_tables(file, tables, commit.sequence + sequence)
        for table in tables.values():
            table.trim()
        file.flush()
    except (OSError, RuntimeError, ValueError) as error:
        abandon(file)
        raise storage_error(path, error) from error
    return file, tables, commit.sequence + 2
