"""Write a log during a run: buffers circulate between the engine and a thread that stores their contents."""

import errno
import json
import math
import os
import queue
import threading
import time
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple, Self

import h5py
import numpy as np

from idealgas.columns import BLOCK, EventBatch, columns_named, empty_batch
from idealgas.errors import OutputError
from idealgas.files import LOG, beside, check_output, give_name, storage_error
from idealgas.log import schema
from idealgas.log.hdf5.commit import Commit
from idealgas.log.hdf5.table_writer import TableWriter, commit_tables, open_tables, write_commit
from idealgas.log.hdf5.writable_file import OPTIONS, WritableFile
from idealgas.log.schema import LogLayout
from idealgas.state import Gas

BUFFERS = 8  # number of buffers for event rows
FLUSH_ROWS = 4 * BLOCK  # number of event rows after which the log is committed
FLUSH_SECONDS = 1.0  # time after which the log is committed, s


class _Rows(NamedTuple):
    """Rows `start` up to, but not including, `stop` of the columns `data`, queued to be stored in a table.

    If `buffer` is not None, the buffer is returned to the pool once the rows are stored. Rows that are `held` are
    committed together with the next checkpoint, never before it.
    """

    table: TableWriter
    start: int
    stop: int
    data: list[np.ndarray]
    buffer: Any = None
    held: bool = False


_END = object()


class LogWriter:
    """A log that is being written; a context manager that closes it as interrupted unless `close` is called first.

    Data are stored in the order of the calls, and committed every 2¹⁸ rows or every second. Committed data survive the
    death of the process and, with `fsync`, also a power failure, unless it leaves a block on the disk half written. If
    data cannot be stored, because the disk is full or the file was removed, the next call raises OutputError with exit
    code 1, and everything committed before remains readable.

    Attributes:
        path: path of the log.
        rows: number of event rows written.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        gas: Gas,
        layout: LogLayout,
        *,
        scene_text: str,
        seed: int,
        command: str = "",
        trajectory: int = 0,
        fsync: bool = False,
        force: bool = False,
    ) -> None:
        """Create the file with all datasets.

        Args:
            path: path of the log.
            gas: discs at the start.
            layout: layout of the log.
            scene_text: scene with all defaults, as TOML.
            seed: seed of the run.
            command: command line of the run.
            trajectory: version of the laws of motion.
            fsync: whether each commit is forced to the disk.
            force: whether to overwrite an existing log.

        Raises:
            OutputError: if the file exists and `force` is false, or if the file cannot be written.
        """
        from idealgas.log.recovery import open_after

        path = Path(path)
        check_output(path, LOG, force)
        part = beside(path)
        sizes = {"scene": len(scene_text.encode()) + schema.SCENE_SLACK, "command": schema.COMMAND_SIZE}
        try:
            with _file_in_memory() as file:
                schema.write_header(file, gas, layout, seed, trajectory)
                schema.create_tables(file, len(gas), layout, sizes)
                commit = Commit.read(file)
                tables = open_tables(file, commit, commit.rows)
                tables["runs"].append(0, 1, _texts(tables["runs"], scene_text, command))
                tables["runs"].store_tail()
                write_commit(file, tables, commit.sequence + 1, size=0)
                commit = Commit.read(file)
                file.flush()
                image = file.id.get_file_image()
            with part.open("wb") as stored:
                stored.write(image)
                if fsync:
                    stored.flush()
                    os.fsync(stored.fileno())
            give_name(part, path, force, fsync)
        except (OSError, RuntimeError) as error:
            raise storage_error(path, error) from error
        except ValueError as error:  # the log would be too large to be read
            raise OutputError(f"{path}: {error}") from error
        finally:
            part.unlink(missing_ok=True)
        self._start(path, *open_after(path, commit.rows, commit), fsync)

    @classmethod
    def resume(
        cls,
        path: str | os.PathLike[str],
        checkpoint: int | None = -1,
        fsync: bool = False,
        scene_text: str | None = None,
        command: str = "",
        commit: Commit | None = None,
    ) -> Self:
        """Continue a log after one of its checkpoints, and remove later rows, checkpoints, samples and snapshots.

        Args:
            path: path of the log.
            checkpoint: index into `Log.checkpoints`; None to continue from the start.
            fsync: whether each commit is forced to the disk.
            scene_text: scene of the run that continues the log, as TOML; None if no new run is to be listed in `runs`.
            command: command line of the new run.
            commit: newest commit that the log must still have; None if any commit is accepted.

        Raises:
            LogError: if there is no such checkpoint, or if the log has another commit.
            OutputError: if the log is being written.
        """
        from idealgas.log.recovery import reopen

        writer = cls.__new__(cls)
        writer._start(Path(path), *reopen(path, checkpoint, commit), fsync)
        if scene_text is not None:
            runs = writer._tables["runs"]
            writer._put(_Rows(runs, 0, 1, _texts(runs, scene_text, command)))
        return writer

    def _start(
        self, path: Path, file: WritableFile, tables: dict[str, TableWriter], sequence: int, fsync: bool
    ) -> None:
        self.path, self._file, self._tables, self._sequence, self._fsync = path, file, tables, sequence, fsync
        self._events = tables.get("events")
        self._flushed = self.rows = self._events.stored if self._events else 0
        self._due, self._held = math.inf, False
        self._names = [path.partition("/")[2] for path in self._events.columns] if self._events else []
        self._free: queue.LifoQueue[EventBatch] = queue.LifoQueue()  # the buffer used last is still in the CPU cache
        for _ in range(BUFFERS if self._events else 0):
            self._free.put(empty_batch(BLOCK + 1, columns_named(self._names)))
        self._queue: queue.Queue[object] = queue.Queue(2 * BUFFERS)
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="log writer", daemon=True)
        self._thread.start()

    # ── the caller's side ──

    def batch(self) -> EventBatch:
        """Return a buffer to be filled, once one is free; only one buffer can be filled at a time.

        The buffer has room for the rest of the current chunk and for one more row, the second row of a pair.
        """
        self._check_open()
        self._lent = self._free.get()
        self._raise()
        return self._lent.rows(self.rows % BLOCK, BLOCK + 1)

    @property
    def behind(self) -> bool:
        """Whether more than one buffer is still waiting to be stored."""
        return self._events is not None and self._free.qsize() < BUFFERS - 1

    def write(self, rows: int, held: bool = False) -> None:
        """Store the first `rows` rows of the buffer from `batch`, which may be read until `batch` is called again.

        held: whether they are committed only together with the next checkpoint, because `resume` cannot repeat them.
        """
        assert self._events is not None, "this log has no events"
        start = self.rows % BLOCK
        self.rows += rows
        data = [getattr(self._lent, name) for name in self._names]
        self._put(_Rows(self._events, start, start + rows, data, self._lent, held))

    def checkpoint(
        self, time: float, epoch: int, arrays: Mapping[str, np.ndarray], values: Mapping[str, float] | None = None
    ) -> None:
        """Store a checkpoint after all event rows written so far and after the sample taken at the same time.

        Args:
            time: time of the state.
            epoch: number of epochs before the state.
            arrays: arrays by declared name, such as the columns with an entry for each disc; they are copied.
            values: single numbers by declared name.
        """
        given = {"time": time, "row": self.rows, "epoch": epoch, **arrays, **(values or {})}
        self._put_row("checkpoints", given)

    def observe(self, time: float, epoch: int, values: Mapping[str, float]) -> None:
        """Store a sample of all observables, given by declared name. epoch: number of epochs before the sample."""
        self._put_row("observables", {"time": time, "step": epoch, **values})

    def change(self, time: float, setting: str) -> None:
        """Store a change to the scene at a time; it takes effect once a checkpoint follows."""
        self._put_row("changes", {"time": time, "setting": setting.encode()})

    def snapshot(self, time: float, step: int, arrays: Mapping[str, np.ndarray]) -> None:
        """Store a snapshot of all discs. step: number of the snapshot; arrays: by declared name, to be copied."""
        self._put_row("particles", {"time": time, "step": step, **arrays})

    def close(self, summary: Mapping[str, Any] | None = None) -> None:
        """Store all queued data and close the file.

        Args:
            summary: fields of the summary, as JSON values, with `end_time` the time up to which the log covers the
                motion. Without a summary, the run counts as interrupted.
        """
        if not self._thread.is_alive():
            return
        if summary is not None:
            self._queue.put(self._summary_rows(summary))
        self._queue.put(_END)
        self._thread.join()
        if self._error is None:
            try:
                self._file.close()
            except (OSError, RuntimeError) as error:
                self._error = error
        else:
            self._file.abandon()
        self._raise()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        try:
            self.close()
        except OutputError:
            if error is None:
                raise

    def _summary_rows(self, summary: Mapping[str, Any]) -> _Rows:
        names, values = list(summary), [json.dumps(value) for value in summary.values()]
        sizes = [np.dtype(column.dtype).itemsize for column in schema.SUMMARY_COLUMNS]
        if not summary or max(map(len, names)) > sizes[0] or max(map(len, values)) > sizes[1]:
            raise ValueError("a summary requires at least one field, and fields must be short")
        return _Rows(self._tables["summary"], 0, len(summary), [np.array(names, "S"), np.array(values, "S")])

    def _put_row(self, name: str, given: Mapping[str, Any]) -> None:
        table = self._tables[name]
        data = []
        for path, column in table.columns.items():
            words = path.split("/")
            entry = given[words[-2] if words[-1] == "value" else words[-1]]
            data.append(np.array(entry, column.dtype).reshape(1, *column.chunk[1:]))
        self._put(_Rows(table, 0, 1, data))

    def _put(self, item: _Rows) -> None:
        self._check_open()
        self._queue.put(item)

    def _check_open(self) -> None:
        """Raise OutputError if no more data can be stored."""
        self._raise()
        if not self._thread.is_alive():
            raise OutputError(f"{self.path}: this log is closed")

    def _raise(self) -> None:
        if self._error is not None:
            raise storage_error(self.path, self._error) from self._error

    # ── the thread's side ──

    def _run(self) -> None:
        item: object = None
        while item is not _END:
            try:
                wait = None if self._held or self._due == math.inf else max(0.0, self._due - time.monotonic())
                item = self._queue.get(timeout=wait)
            except queue.Empty:
                item = None
            if self._error is None:
                try:
                    self._store(item)
                except Exception as error:
                    self._error, self._due = error, math.inf
            if isinstance(item, _Rows) and item.buffer is not None:
                self._free.put(item.buffer)

    def _store(self, item: object) -> None:
        """Store the rows of an item, if any, and commit them if due; a first checkpoint is committed immediately."""
        if isinstance(item, _Rows):
            item.table.append(item.start, item.stop, item.data)
            self._held = item.held or (self._held and item.table is not self._tables["checkpoints"])
            delay = FLUSH_SECONDS if self._tables["checkpoints"].stored else 0.0
            self._due = min(self._due, time.monotonic() + delay)
        if item is _END:
            for _ in range(2):  # so that both slots of the commit record contain the end
                self._commit(tails=True, last=True)
        elif not self._held and time.monotonic() >= self._due:
            self._commit(tails=True)
        elif not self._held and self._events and self._events.whole - self._flushed >= FLUSH_ROWS:
            self._commit(tails=False)

    def _commit(self, tails: bool, last: bool = False) -> None:
        """Commit all rows, or, without `tails`, only full chunks of event rows. last: whether the log ends here."""
        if self._file.removed:
            raise FileNotFoundError(errno.ENOENT, "the file was removed")
        for table in self._tables.values():
            if tails or table is not self._events:
                table.store_tail(last)
        self._sequence += 1
        commit_tables(self._file.file, self._tables, self._sequence, self._fsync)
        if self._events:
            self._flushed = self._events.whole
        self._due = math.inf if tails else time.monotonic() + FLUSH_SECONDS


def _file_in_memory() -> h5py.File:
    """Create an HDF5 file in memory, because HDF5 may crash while creating a file on a full or failing disk."""
    name = uuid.uuid4().hex  # HDF5 refuses a second file with the same name, even in memory
    return h5py.File(name, "w", driver="core", backing_store=False, **OPTIONS, **schema.PAGES)


def _texts(runs: TableWriter, scene_text: str, command: str) -> list[np.ndarray]:
    """Return a row of `runs`, with the command truncated if too long. Raises ValueError if the scene does not fit."""
    scene_size, command_size = (column.dtype.itemsize for column in runs.columns.values())
    line = command.encode(errors="backslashreplace")  # file names need not be UTF-8
    scene, cut = scene_text.encode(), line[:command_size].decode(errors="ignore").encode()
    if len(scene) > scene_size:
        raise ValueError("the scene's text does not fit")
    return [np.array([scene], f"S{scene_size}"), np.array([cut], f"S{command_size}")]
