"""Reading a log: whole chunks, in bounded memory, whether its writer ended, died or still lives.

    from idealgas import open_log

    with open_log("run.h5") as log:
        print(log.discs.temperature, len(log), log.end_time, log.summary)
        for block in log.chunks(("time", "disc", "velocity"), log.row_at(50.0)):
            print(block.time[-1], (block.velocity**2).sum(axis=1).mean())
        for hits in log.events(disc=0, t0=10.0, t1=20.0):
            print(hits.time, hits.partner)
        print(log.state_at(12.5).position)
        for state in log.frames(np.linspace(0, log.end_time, 100)):
            print(state.time, state.position.mean(axis=0))

Without this package the columns are plain datasets:

    import h5py, json
    with h5py.File("run.h5") as log:  # swmr=True while its writer lives, or if it died
        rows = min(len(column) for column in log["events"].values())
        for start in range(0, rows, 65536):
            block = slice(start, min(start + 65536, rows))
            time, disc = log["events/time"][block], log["events/disc"][block]
            energy = log["discs/mass"][:][disc] / 2 * (log["events/velocity"][block] ** 2).sum(axis=1)
            print(time[-1], energy.mean())
        print(dict(zip(log["summary/name"], log["summary/value"])) or "interrupted")
"""

import json
import os
from collections import namedtuple
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property, partial
from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from idealgas.events import IMAGE, EventBatch, Kind, columns_named
from idealgas.gas.state import Gas
from idealgas.log.errors import LogError
from idealgas.log.hdf5.superblock import is_locked
from idealgas.log.replay import Checkpoint, Checkpoints, LogState, Replay
from idealgas.log.schema import DISC_COLUMNS, Wall
from idealgas.log.source import ATTEMPTS, PAUSE, Source

if TYPE_CHECKING:
    from idealgas.scene import Scene


def open_log(path: str | os.PathLike[str]) -> "Log":
    """Open a log for reading. Raises LogError if it is not one or is damaged, and so do all of its methods."""
    for _ in range(ATTEMPTS):
        try:
            return Log(Source(Path(path)))
        except LogError:
            if not os.path.exists(path) or not is_locked(Path(path)):
                raise
            sleep(PAUSE)  # a run that goes on with the log may have cut off what its record named just before
    return Log(Source(Path(path)))


class Log:
    """A log open for reading; a context manager.

    path: the file. unclosed: its writer died or still lives. complete: the run came to its end. has_events: events were
    kept. box: (Lx, Ly). gravity: length/time². periodic: which axes are periodic. start_time. len() is the number of
    event rows that hold, at a whole event.
    """

    start_time = 0.0

    def __init__(self, source: Source) -> None:
        self._source = source
        self.path = source.path
        self.unclosed = source.unclosed
        self.box: tuple[float, float] = tuple(source.fixed("box").tolist())
        self.gravity: tuple[float, float] = tuple(source.fixed("gravity").tolist())
        self.periodic = tuple(word == b"periodic" for word in source.attribute("box", "boundary").tolist())
        self._update()

    @property
    def live(self) -> bool:
        """Whether another process is writing the log now."""
        return self.unclosed and is_locked(self.path)

    def refresh(self) -> None:
        """See what a living writer has stored meanwhile."""
        self._source.refresh()
        self._update()

    def _update(self) -> None:
        self.commit = self._source.commit
        self.complete = self.commit.complete
        self.has_events = "events" in self.commit.rows
        self._rows = self.commit.rows.get("events", 0)
        self._block = self._source.chunk_rows("events/time") if self.has_events else 1
        if self._rows:
            start = (self._rows - 1) // self._block * self._block
            disc, partner, kind = (
                self._source.chunk(f"events/{name}", start)[self._rows - 1 - start]
                for name in ("disc", "partner", "kind")
            )
            if kind == Kind.DISC and disc < partner:  # the first row of a pair, whose second did not get here
                self._rows -= 1
        self._first_times: dict[int, float] = {}
        for name in ("runs", "checkpoints", "observables", "snapshot_times", "summary", "end_time"):
            self.__dict__.pop(name, None)

    def close(self) -> None:
        """Close the file."""
        self._source.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __len__(self) -> int:
        return self._rows

    # ── what was known before the run ──

    @cached_property
    def runs(self) -> list[tuple[str, str]]:
        """Scene (resolved, TOML) and command of each run that wrote into the file; they differ in where it ends."""
        texts = (
            [text.decode() for text in self._source.column(f"runs/{name}").tolist()] for name in ("scene", "command")
        )
        return list(zip(*texts, strict=True))

    @property
    def scene_text(self) -> str:
        """The resolved scene of the last run, TOML."""
        return self.runs[-1][0]

    @cached_property
    def scene(self) -> "Scene":
        """The resolved scene."""
        from idealgas.scene import parse_scene

        return parse_scene(self.scene_text, name=f"{self.path}: scene")

    @property
    def command(self) -> str:
        """The command of the last run."""
        return self.runs[-1][1]

    @cached_property
    def attributes(self) -> dict[str, Any]:
        """format, format_version, seed, created (UTC), and the versions of the programs that made it.

        trajectory: version of the laws that moved the discs.
        """
        return self._source.attributes("/") | self._source.attributes("versions")

    @cached_property
    def discs(self) -> Gas:
        """The start state."""
        columns = {column.name: self._source.fixed(f"discs/{column.name}") for column in DISC_COLUMNS}
        return Gas(box=self.box, species_names=tuple(self._source.texts("discs/species_name")), **columns)

    @cached_property
    def inertia(self) -> np.ndarray | None:
        """(N,) moment of inertia of each disc, mass length²; None where discs do not spin."""
        spins = "angular_velocity" in self._source.names("checkpoints")
        return self._source.fixed("discs/inertia") if spins else None

    @cached_property
    def walls(self) -> list[Wall]:
        """Wall k is the partner -1 - k of events."""
        ends = self._source.fixed("walls/endpoints").tolist()
        return [Wall(name, *map(tuple, end)) for name, end in zip(self._source.texts("walls/name"), ends, strict=True)]

    # ── what the run stored ──

    @cached_property
    def checkpoints(self) -> Checkpoints:
        """States that the run can go on from."""
        return Checkpoints(self._source, len(self))

    @cached_property
    def observables(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Times and values of each observable, by name."""
        names = [name.partition("/")[0] for name in self._source.names("observables") if name.endswith("/value")]
        times = next((name for name in self._source.names("observables") if name.endswith("/time")), "")
        return {
            name: (self._source.column(f"observables/{times}"), self._source.column(f"observables/{name}/value"))
            for name in names
        }

    @cached_property
    def snapshot_times(self) -> np.ndarray:
        """Times of the snapshots, which lie as H5MD in `particles/discs`."""
        times = next((name for name in self._source.names("particles") if name.endswith("/time")), None)
        return self._source.column(f"particles/{times}") if times else np.empty(0)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """What the run told of itself at its end; empty if it did not come there."""
        names, values = (self._source.column(f"summary/{name}").tolist() for name in ("name", "value"))
        return {name.decode(): json.loads(value) for name, value in zip(names, values, strict=True)}

    @cached_property
    def end_time(self) -> float:
        """Time up to which the log is complete."""
        if "end_time" in self.summary:
            return self.summary["end_time"]
        last = [self.start_time]
        if len(self.checkpoints):
            last.append(self.checkpoints.times[-1].item())
        if len(self):
            last.append(self._times((len(self) - 1) // self._block * self._block)[-1].item())
        return max(last)

    @property
    def has_positions(self) -> bool:
        """Whether the method knows where the discs are; their positions in `frames` are not numbers if it does not."""
        return "position" in self._source.names("checkpoints")

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the event columns."""
        return tuple(self._source.names("events"))

    def chunks(self, columns: Sequence[str] | None = None, start: int = 0, stop: int | None = None) -> Iterator[Any]:
        """Event rows from `start` up to `stop`, in blocks that are whole chunks, of at most 65 536, or parts of them.

        A block is an EventBatch, or a named tuple of the columns asked for. Raises LogError for one that is not there.
        """
        block: Any = partial(EventBatch, position=None) if columns is None else namedtuple("Rows", columns)
        names = self.columns if columns is None else columns
        if self.has_events and (missing := [name for name in names if name not in self.columns]):
            raise LogError(f"{self.path}: its events have no {' and no '.join(missing)} ({self.scene.run.method})")
        stop = len(self) if stop is None else min(stop, len(self))
        for first in range(start // self._block * self._block, stop, self._block) if start < stop else ():
            some = slice(max(start - first, 0), stop - first)
            yield block(**{name: self._source.chunk(f"events/{name}", first)[some] for name in names})

    def row_at(self, time: float, side: str = "left") -> int:
        """The first event row at `time` or later; with side "right", later than `time`. Reads O(log n) chunks."""
        low, high = 0, -(-len(self) // self._block)  # the row lies in one of these chunks, or just behind the last
        while high - low > 1:
            middle = (low + high) // 2
            if middle not in self._first_times:
                self._first_times[middle] = self._times(middle * self._block)[0].item()
            first = self._first_times[middle]
            if first < time or (first == time and side == "right"):
                low = middle
            else:
                high = middle
        times = self._times(low * self._block) if len(self) else np.empty(0)
        return low * self._block + int(times.searchsorted(time, side))  # type: ignore[call-overload]

    def events(self, disc: int | None = None, t0: float | None = None, t1: float | None = None) -> Iterator[Any]:
        """Event rows of one disc or all, from time `t0` until before `t1`, in blocks as `chunks` gives them."""
        start = 0 if t0 is None else self.row_at(t0)
        stop = len(self) if t1 is None else self.row_at(t1)
        if disc is None:
            yield from self.chunks(None, start, stop)
            return
        row = start
        for ids in self.chunks(("disc",), start, stop):
            own = np.flatnonzero(ids.disc == disc)
            for block in self.chunks(None, row, row + len(ids.disc)) if len(own) else ():
                yield block._make(None if column is None else column[own] for column in block)
            row += len(ids.disc)

    def state_at(self, time: float) -> LogState:
        """All discs at a time; at the time of events, after them."""
        return next(self.frames([time]))

    def frames(self, times: Iterable[float]) -> Iterator[LogState]:
        """All discs at times that do not decrease, in one pass. Raises LogError at one that the log does not cover."""
        replay: Replay | None = None
        base = -1
        earliest = self.start_time
        for time in times:
            if not earliest <= time <= self.end_time:
                raise LogError(f"{self.path}: no state at time {time:g} (got up to {self.end_time:g}, asked in order)")
            earliest = time
            nearest = int(self.checkpoints.times.searchsorted(time, "right")) - 1
            if not self.has_events and (nearest < 0 or self.checkpoints.times[nearest] != time):
                raise LogError(f"{self.path}: no state at time {time:g}: without events only at checkpoints")
            if replay is None or nearest > base:
                replay, base = self._replay(nearest), nearest
            for block in self.chunks(("time", "disc", *replay.state), replay.row, self.row_at(time, "right")):
                replay.follow(block)
            yield replay.at(time)

    def _replay(self, checkpoint: int) -> Replay:
        start = self.checkpoints[checkpoint] if checkpoint >= 0 else self._start
        return Replay(start, self.columns, self.box, self.periodic, self.gravity)

    @property
    def _start(self) -> Checkpoint:
        """The start state, as a checkpoint would have it; images count from there on."""
        arrays = {}
        for column in columns_named(self.columns):
            if column is IMAGE:
                arrays[column.name] = np.zeros((len(self.discs), *column.shape), column.dtype)
            elif column.name in LogState._fields[1:]:
                arrays[column.name] = self._source.fixed(f"discs/{column.name}")
        return Checkpoint(self.start_time, 0, 0, arrays, {})

    def _times(self, first: int) -> np.ndarray:
        return self._source.chunk("events/time", first)[: len(self) - first]
