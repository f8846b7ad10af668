"""Read the event rows of a log in blocks, and compute the state of the gas at any time."""

from bisect import bisect_left, bisect_right
from collections import namedtuple
from collections.abc import Iterable, Iterator, Sequence
from functools import cache, cached_property, partial
from typing import Any, Literal, Self, overload

import numpy as np

from idealgas.columns import EventBatch, Kind
from idealgas.locks import is_locked
from idealgas.log.errors import DamageError, LogError
from idealgas.log.header import LogHeader
from idealgas.log.log_file import LogFile, StoredTable
from idealgas.log.pairs import check_pairs
from idealgas.log.replay import Checkpoint, Checkpoints, LogState, Replay
from idealgas.log.schema import SUMMARY_COLUMNS
from idealgas.log.summary import parse_summary

COUNTS = ("events", "disc_collisions", "trials")
"""Quantities that every run counts; a stop rule may set the final value of any of them."""


_CACHED = ("runs", "checkpoints", "observables", "snapshot_times", "summary", "changes", "end_time", "counts")
"""Cached properties that change while the run is writing the log."""


@cache
def _rows(columns: tuple[str, ...]) -> Any:
    """Return the type of blocks with these columns; creating a type takes longer than reading a short block."""
    return namedtuple("Rows", columns)


class LogHistory(LogHeader):
    """The part of a `Log` that is written during the run, except samples; see `Log` for the attributes."""

    start_time = 0.0

    def __init__(self, file: LogFile) -> None:
        try:
            super().__init__(file)
            self._update()
        except LogError:
            file.close()
            raise

    @property
    def live(self) -> bool:
        """Whether a run is currently writing this log."""
        return self.unclosed and is_locked(self.path)

    def require_events(self) -> None:
        """Raise LogError if the log has no events."""
        if not self.has_events:
            raise LogError(f"{self.path}: has no events (made with log.events = false)")

    def refresh(self) -> None:
        """Make available everything that the run has written since the log was opened or last refreshed."""
        self._file.refresh()
        self._update()

    def _update(self) -> None:
        self.commit = self._file.commit
        self.complete = self.commit.complete
        self.has_events = "events" in self.commit.rows
        self._rows = self.commit.rows.get("events", 0)
        self._block = self._file.chunk_rows("events/time") if self.has_events else 1
        if self._rows:
            start = (self._rows - 1) // self._block * self._block
            last = {name: self._file.chunk(f"events/{name}", start) for name in ("disc", "partner", "kind")}
            self._file.checked(partial(check_pairs, last, start))
            if last["disc"][-1] < last["partner"][-1]:  # the second row of this pair is not yet committed
                self._rows -= 1
        self._first_times: dict[int, float] = {}
        for name in _CACHED:
            self.__dict__.pop(name, None)
        if self._file.rows("changes"):
            for name in ("scene", "_steps_of_gravity"):
                self.__dict__.pop(name, None)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __len__(self) -> int:
        return self._rows

    @cached_property
    def checkpoints(self) -> Checkpoints:
        """States at the beginnings of epochs, from which the run can be resumed; each is read when it is indexed."""
        checkpoints = Checkpoints(self._file, len(self), self._check_checkpoint)
        if self.complete and len(checkpoints) < self._file.rows("checkpoints"):
            row = self._file.column("checkpoints/row")[-1]
            raise DamageError(self.path, f"checkpoints/row: {row} (allowed up to {len(self)}, all events)")
        return checkpoints

    def _check_checkpoint(self, time: float, row: int) -> None:
        """Raise DamageError unless the number of rows before a checkpoint agrees with its time."""
        if self.has_events and not self.row_at(time) <= row <= self.row_at(time, "right"):
            raise DamageError(
                self.path, f"checkpoints/row: {row} at t = {time:g} (disagrees with the times of the events)"
            )

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Fields of the run's `Summary`, by name; empty if the run has not reached its end."""
        names, values = (self._file.column(f"summary/{column.name}").tolist() for column in SUMMARY_COLUMNS)
        fields = self._file.checked(lambda: parse_summary(names, values), "summary/value")
        if self.has_events and fields.get("rows", len(self)) != len(self):
            raise DamageError(self.path, f"summary/value: {fields['rows']} rows (events: {len(self)})")
        return StoredTable(self.path, "summary", fields)

    @cached_property
    def end_time(self) -> float:
        """Time up to which the log covers the motion of the gas."""
        last = [self.start_time]
        if len(self.checkpoints):
            last.append(self.checkpoints.times[-1].item())
        if len(self):
            last.append(self._times((len(self) - 1) // self._block * self._block)[-1].item())
        elif not (self.has_events or self.complete):
            last += self._sample_times("observables", 1)[-1:].tolist()
        end = self.summary.get("end_time", max(last))
        if end < max(last):
            raise DamageError(self.path, f"summary/value: end_time {end:g} (allowed from {max(last):g} on)")
        return end

    def _sample_times(self, table: str, step: int) -> np.ndarray:
        """Return the times of every `step`-th row in a table of samples; an empty array if there is no such table."""
        path = next((f"{table}/{name}" for name in self._file.names(table) if name.endswith("/time")), None)
        times = self._file.column(path, step) if path else np.empty(0)
        if self.complete and len(times) and times[-1] > self.end_time:
            raise DamageError(self.path, f"{path}: {times[-1]:g} (allowed up to {self.end_time:g}, the end)")
        return times

    @cached_property
    def counts(self) -> dict[str, int]:
        """Numbers of `events`, `disc_collisions` and `trials` up to the end of the log.

        If the log has no event rows, the numbers are those of the last sample.
        """
        if self.complete:
            return {name: self.summary[name] for name in COUNTS}
        if not self.has_events:
            samples = {name: self._file.column(f"observables/{name}/value") for name in COUNTS}
            return {name: int(values[-1]) if len(values) else 0 for name, values in samples.items()}
        last = self.checkpoints[-1] if len(self.checkpoints) else None
        events, collisions, trials = (int(last.values[name]) if last else 0 for name in COUNTS)
        if (first := last.row if last else 0) < len(self):
            pairs = sum(int((rows.kind == Kind.DISC).sum()) for rows in self.chunks(("kind",), first)) // 2
            events, collisions = events + len(self) - first - pairs, collisions + pairs
            if not self.has_positions:
                (end,) = self.chunks(("trial",), len(self) - 1)
                trials = int(end.trial[-1])
        return dict(zip(COUNTS, (events, collisions, trials), strict=True))

    @property
    def has_positions(self) -> bool:
        """Whether the discs have positions; in a run with the Monte Carlo method, all positions are nan."""
        return "position" in self._file.names("checkpoints")

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of `EventBatch` that this log contains; empty if the log has no events."""
        return tuple(self._file.names("events"))

    @overload
    def chunks(self, columns: None = None, start: int = 0, stop: int | None = None) -> Iterator[EventBatch]: ...
    @overload
    def chunks(self, columns: Sequence[str], start: int = 0, stop: int | None = None) -> Iterator[Any]: ...
    def chunks(self, columns: Sequence[str] | None = None, start: int = 0, stop: int | None = None) -> Iterator[Any]:
        """Yield event rows in blocks of at most 65 536 rows.

        Args:
            columns: names of the columns to read; each block is then a named tuple of arrays, (n,) or (n, 2). By
                default, each block is an `EventBatch`, whose documentation describes the columns.
            start: number of the first row.
            stop: number of the row after the last row; by default the end of the log.

        Raises:
            LogError: if the log does not have a column.
        """
        block: Any = partial(EventBatch, position=None) if columns is None else _rows(tuple(columns))
        names = self.columns if columns is None else columns
        if self.has_events and (missing := [name for name in names if name not in self.columns]):
            raise LogError(f"{self.path}: events of method {self.scene.run.method} have no {' and no '.join(missing)}")
        stop = len(self) if stop is None else min(stop, len(self))
        for first in range(start // self._block * self._block, stop, self._block) if start < stop else ():
            rows = {name: self._file.chunk(f"events/{name}", first) for name in names}
            self._file.checked(partial(check_pairs, rows, first))
            chosen = slice(max(start - first, 0), stop - first)
            yield block(**{name: column[chosen] for name, column in rows.items()})

    def row_at(self, time: float, side: Literal["left", "right"] = "left") -> int:
        """Return the number of the first event row at or after `time`, or strictly after it if `side` is "right"."""
        if not len(self):
            return 0
        find = bisect_left if side == "left" else bisect_right
        blocks = range(-(-len(self) // self._block))
        first = max(find(blocks, time, key=self._first_time) - 1, 0) * self._block
        return first + int(self._times(first).searchsorted(time, side))

    def _first_time(self, block: int) -> float:
        if block not in self._first_times:
            self._first_times[block] = self._times(block * self._block)[0].item()
        return self._first_times[block]

    def events(self, disc: int | None = None, t0: float | None = None, t1: float | None = None) -> Iterator[EventBatch]:
        """Yield event rows at times t0 ≤ t < t1, in blocks (`EventBatch`) of any length.

        Args:
            disc: id of a disc; all discs by default.
            t0: start of the window; by default the start of the log.
            t1: end of the window; by default the end of the log, including events at that time.
        """
        start = 0 if t0 is None else self.row_at(t0)
        stop = len(self) if t1 is None else self.row_at(t1)
        if disc is None:
            yield from self.chunks(None, start, stop)
            return
        row = start
        for ids in self.chunks(("disc",), start, stop):
            chosen = np.flatnonzero(ids.disc == disc)
            for block in self.chunks(None, row, row + len(ids.disc)) if len(chosen) else ():
                yield EventBatch._make(None if column is None else column[chosen] for column in block)
            row += len(ids.disc)

    def state_at(self, time: float) -> LogState:
        """Return the exact state of all discs at one time; at the time of an event, the state after the event.

        Args:
            time: time of the state.

        Raises:
            LogError: if the log does not contain a state at this time; see `frames`.
        """
        return next(self.frames([time]))

    def frames(self, times: Iterable[float]) -> Iterator[LogState]:
        """Yield the states of all discs at several times, in a single pass over the log.

        The states are exact, because every disc moves freely after its last event. A log without events contains states
        only at its checkpoints.

        Args:
            times: times in increasing order.

        Raises:
            LogError: if a time is out of order or the log contains no state at this time.
        """
        replay: Replay | None = None
        base = -1
        earliest = self.start_time
        for time in times:
            if not earliest <= time <= self.end_time:
                raise LogError(
                    f"{self.path}: no state at time {time:g} (allowed up to {self.end_time:g}, in increasing order)"
                )
            earliest = time
            nearest = int(self.checkpoints.times.searchsorted(time, "right")) - 1
            if not self.has_events and (nearest < 0 or self.checkpoints.times[nearest] != time):
                raise LogError(
                    f"{self.path}: no state at time {time:g}: a log without events has states only at its checkpoints"
                )
            if replay is None or nearest > base:
                replay, base = self._replay(nearest), nearest
            for block in self.chunks(replay.columns, replay.row, self.row_at(time, "right")):
                replay.follow(block)
            yield self._file.checked(partial(replay.at, time), f"the state at time {time:g}")

    def _replay(self, checkpoint: int) -> Replay:
        if checkpoint >= 0:
            start = self.checkpoints[checkpoint]
        else:
            start = Checkpoint(self.start_time, 0, 0, self._start_arrays(), {})
        gravity_at = self.gravity_at if self.has_gravity else None
        return Replay(start, self.columns, self.box, self.wrapped_axes, gravity_at, self.escapes)

    def _start_arrays(self) -> dict[str, np.ndarray]:
        """Return the initial state of the discs as arrays by name, as in a checkpoint."""
        names = self._file.names("checkpoints")
        arrays = {"velocity": self.discs.velocity, "position": self.discs.position}
        if not self.has_positions:
            arrays["position"] = np.full_like(self.discs.position, np.nan)
        if "image" in names:
            arrays["image"] = np.zeros((len(self.discs), 2), np.int32)
        if "angular_velocity" in names:
            arrays["angular_velocity"] = self._file.fixed("discs/angular_velocity")
        return arrays

    def _times(self, first: int) -> np.ndarray:
        return self._file.chunk("events/time", first)[: len(self) - first]
