"""Reading a log: its events, the state of the gas at any time, its samples and its summary.

A log can be read during its run, and after it was interrupted or killed. Events are read in blocks, so that a log may
be larger than memory.

    import numpy as np
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
    with h5py.File("run.h5") as log:  # swmr=True while it is written, or if it was not closed
        rows = min(len(column) for column in log["events"].values())
        for start in range(0, rows, 65536):
            block = slice(start, min(start + 65536, rows))
            time, disc = log["events/time"][block], log["events/disc"][block]
            energy = log["discs/mass"][:][disc] / 2 * (log["events/velocity"][block] ** 2).sum(axis=1)
            print(time[-1], energy.mean())
        print(dict(zip(log["summary/name"], log["summary/value"])) or "interrupted")
"""

import os
from collections import namedtuple
from collections.abc import Iterable, Iterator, Sequence
from functools import cache, cached_property, partial
from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING, Any, Literal, Self, overload

import numpy as np
from numpy.typing import ArrayLike

from idealgas.columns import EventBatch
from idealgas.errors import plain
from idealgas.files import is_locked
from idealgas.log.dataframes import (
    KIND_NAMES,
    check_choice,
    data_frame,
    flat_discs,
    flat_events,
    flat_flights,
    flat_samples,
)
from idealgas.log.errors import DamageError, LogError
from idealgas.log.flights import FlightReader, Flights
from idealgas.log.header import LogHeader
from idealgas.log.log_file import ATTEMPTS, PAUSE, LogFile, Table
from idealgas.log.pairs import check_pairs
from idealgas.log.replay import Checkpoint, Checkpoints, LogState, Replay
from idealgas.log.schema import SUMMARY_COLUMNS
from idealgas.log.summary import parse_summary

if TYPE_CHECKING:
    from pandas import DataFrame


def open_log(path: str | os.PathLike[str]) -> "Log":
    """Open the log of a run for reading, in a `with` statement or with a call of `close` at the end.

    Args:
        path: path of the log.

    Raises:
        LogError: if the file is missing, damaged, or not a log of idealgas. All methods of `Log` raise it too, as most
            of the file is read on demand.
    """
    for _ in range(ATTEMPTS):
        try:
            return Log(LogFile(Path(path)))
        except LogError:
            if not os.path.exists(path) or not is_locked(Path(path)):
                raise
            sleep(PAUSE)  # a run that resumes the log may just have removed rows
    return Log(LogFile(Path(path)))


@cache
def _rows(columns: tuple[str, ...]) -> Any:
    """Type of blocks of rows with these columns, cached, as creating it takes longer than reading a short block."""
    return namedtuple("Rows", columns)


class Log(LogHeader):
    """The log of a run, open for reading; a context manager that closes the file. Use `open_log` to create it.

    `len(log)` is the number of event rows, two for a collision of two discs and one for any other event. `print(log)`
    shows the scene, the state of the run, and the file. Energies and temperatures are in units of mass length²/time²,
    with Boltzmann's constant 1. Methods and properties raise LogError if the data they need are damaged.

    Attributes:
        path: path of the file.
        complete: whether the run reached its end.
        unclosed: whether the file was not closed: it is still written (see `live`), or its run was killed.
        has_events: whether the log has event rows.
        box: (Lx, Ly), length; the origin is the lower left corner.
        periodic: whether the box is periodic along x and along y.
        gravity: (gx, gy), length/time².
        start_time: 0.
    """

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
        """Whether another process is writing this log now."""
        return self.unclosed and is_locked(self.path)

    @property
    def run_state(self) -> str:
        """State of the run: "complete", "running", "not closed (crash?)" or "interrupted"."""
        if self.complete:
            return "complete"
        if self.unclosed:
            return "running" if self.live else "not closed (crash?)"
        return "interrupted"

    def __str__(self) -> str:
        """Three lines: scene and discs; time span, events and state of the run; file."""
        from rich.filesize import decimal

        scene, names = self.scene, self.discs.species_names
        counts = np.bincount(self.discs.species, minlength=len(names))
        species = ", ".join(f"{count:,} {name}" for name, count in zip(names, counts, strict=True))
        rows = f"{len(self):,} event rows" if self.has_events else "without event rows"
        events = f"{self.summary['events']:,} events" if self.complete else rows
        lines = (
            f"{scene.scene.title or 'untitled scene'}: {len(self.discs):,} discs ({species}), {scene.run.method}",
            f"t = {self.start_time:g} to {self.end_time:g}: {events}, {self.run_state}",
            f"{self.path}: {decimal(self.path.stat().st_size)}",
        )
        return "\n".join(plain(line.replace("\n", "\\n")) for line in lines)

    def refresh(self) -> None:
        """Read what the run has stored since the log was opened or last refreshed."""
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
            if last["disc"][-1] < last["partner"][-1]:  # the first row of a pair whose second is not committed
                self._rows -= 1
        self._first_times: dict[int, float] = {}
        for name in ("runs", "checkpoints", "observables", "snapshot_times", "summary", "end_time"):
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
        """States at the starts of epochs, from which the run can be resumed; each is read when it is indexed."""
        found = Checkpoints(self._file, len(self), self._check_checkpoint)
        if self.complete and len(found) < self._file.rows("checkpoints"):
            row = self._file.column("checkpoints/row")[-1]
            raise DamageError(self.path, f"checkpoints/row: {row} (allowed up to {len(self)}, all events)")
        return found

    def _check_checkpoint(self, time: float, row: int) -> None:
        """Raise DamageError unless the event rows before a checkpoint are those before its time."""
        if self.has_events and not self.row_at(time) <= row <= self.row_at(time, "right"):
            raise DamageError(self.path, f"checkpoints/row: {row} at t = {time:g} (got other events before it)")

    @cached_property
    def observables(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Samples taken during the run: times (P,) and values (P,) or (P, components), by name.

        Every log has kinetic_energy, momentum, energy (of the discs), overlap (deepest, relative to the sum of two
        radii), outside (farthest reach out of the box, in diameters), and the numbers of events, disc_collisions,
        wall_hits and trials since the start. Effects add rotational_energy, potential_energy, piston_position,
        piston_velocity, wall_energy (from each wall since the start), dissipated_energy (lost since the start in
        collisions of discs, then at each wall), thermostat_collisions and bath_energy (since the start). With
        `log.pressure` samples have the sums of idealgas/log/README.md: kinetic_flow, collision_flow, wall_virial,
        face_normal_impulse, face_tangential_impulse, face_hits and, in mixtures, pair_collisions; with
        `log.heat_flow` also kinetic_heat_flow and collision_heat_flow.
        """
        names = [name.partition("/")[0] for name in self._file.names("observables") if name.endswith("/value")]
        times = next((name for name in self._file.names("observables") if name.endswith("/time")), "")
        found = {
            name: (self._file.column(f"observables/{times}"), self._file.column(f"observables/{name}/value"))
            for name in names
        }
        return Table(self.path, "observables", found)

    @cached_property
    def snapshot_times(self) -> np.ndarray:
        """(S,) times of the snapshots, which `log.snapshot_every` adds to the file as in H5MD."""
        times = next((name for name in self._file.names("particles") if name.endswith("/time")), None)
        return self._file.column(f"particles/{times}") if times else np.empty(0)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Fields of the run's `Summary` by name; empty if the run has not reached its end."""
        names, values = (self._file.column(f"summary/{column.name}").tolist() for column in SUMMARY_COLUMNS)
        found = self._file.checked(lambda: parse_summary(names, values), "summary/value")
        if self.has_events and found.get("rows", len(self)) != len(self):
            raise DamageError(self.path, f"summary/value: {found['rows']} rows (events: {len(self)})")
        return Table(self.path, "summary", found)

    @cached_property
    def end_time(self) -> float:
        """Time up to which the log covers the motion of the gas."""
        last = [self.start_time]
        if len(self.checkpoints):
            last.append(self.checkpoints.times[-1].item())
        if len(self):
            last.append(self._times((len(self) - 1) // self._block * self._block)[-1].item())
        end = self.summary.get("end_time", max(last))
        if end < max(last):
            raise DamageError(self.path, f"summary/value: end_time {end:g} (allowed from {max(last):g} on)")
        return end

    @property
    def has_positions(self) -> bool:
        """Whether the discs have positions; in the Monte Carlo method they are nan."""
        return "position" in self._file.names("checkpoints")

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the event columns, those of `EventBatch` that this log has; empty without events."""
        return tuple(self._file.names("events"))

    @overload
    def chunks(self, columns: None = None, start: int = 0, stop: int | None = None) -> Iterator[EventBatch]: ...
    @overload
    def chunks(self, columns: Sequence[str], start: int = 0, stop: int | None = None) -> Iterator[Any]: ...
    def chunks(self, columns: Sequence[str] | None = None, start: int = 0, stop: int | None = None) -> Iterator[Any]:
        """Event rows in blocks of at most 65 536 rows.

        Args:
            columns: names of the columns to read; each block is then a named tuple of arrays, (n,) or (n, 2). By
                default it is an `EventBatch`, which describes the columns.
            start: number of the first row.
            stop: number after the last row; by default the end of the log.

        Raises:
            LogError: if the log lacks a column.
        """
        block: Any = partial(EventBatch, position=None) if columns is None else _rows(tuple(columns))
        names = self.columns if columns is None else columns
        if self.has_events and (missing := [name for name in names if name not in self.columns]):
            raise LogError(f"{self.path}: events of method {self.scene.run.method} have no {' and no '.join(missing)}")
        stop = len(self) if stop is None else min(stop, len(self))
        for first in range(start // self._block * self._block, stop, self._block) if start < stop else ():
            rows = {name: self._file.chunk(f"events/{name}", first) for name in names}
            self._file.checked(partial(check_pairs, rows, first))
            some = slice(max(start - first, 0), stop - first)
            yield block(**{name: column[some] for name, column in rows.items()})

    def row_at(self, time: float, side: str = "left") -> int:
        """Number of the first event row at `time` or later; with side "right" of the first one after `time`."""
        low, high = 0, -(-len(self) // self._block)  # the row is in one of these chunks, or follows the last
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

    def events(self, disc: int | None = None, t0: float | None = None, t1: float | None = None) -> Iterator[EventBatch]:
        """Event rows at times t0 ≤ t < t1, in blocks (`EventBatch`) of any length.

        Args:
            disc: id of the disc; all by default.
            t0: start of the window; by default that of the log.
            t1: end of the window; by default that of the log.
        """
        start = 0 if t0 is None else self.row_at(t0)
        stop = len(self) if t1 is None else self.row_at(t1)
        if disc is None:
            yield from self.chunks(None, start, stop)
            return
        row = start
        for ids in self.chunks(("disc",), start, stop):
            own = np.flatnonzero(ids.disc == disc)
            for block in self.chunks(None, row, row + len(ids.disc)) if len(own) else ():
                yield EventBatch._make(None if column is None else column[own] for column in block)
            row += len(ids.disc)

    def flights(
        self,
        edges: ArrayLike | None = None,
        *,
        discs: ArrayLike | None = None,
        columns: Sequence[str] | None = None,
    ) -> Iterator[Flights]:
        """Flights of discs from event to event, in batches of at most 131 072, unless a single one has more pieces.

        A flight has the state in which a disc begins it, and the event that ends it; `Flights` describes the columns.
        The flights of a disc fill the time from the first edge to the last, and are cut at the edges in between.

        Args:
            edges: (B + 1,), times in increasing order; by default the start and the end of the log.
            discs: ids of the discs to follow; all by default.
            columns: names of the columns to make, which takes less time; all that the log has by default.

        Raises:
            LogError: if the log has no events, if its flights have no such column, if there is no such disc, or if the
                log does not cover the edges.
        """
        return FlightReader(self, edges, discs, columns).batches()

    def state_at(self, time: float) -> LogState:
        """All discs at one time, exactly; at the time of an event after the event. Raises LogError as `frames` does."""
        return next(self.frames([time]))

    def frames(self, times: Iterable[float]) -> Iterator[LogState]:
        """All discs at each of several times, in one pass over the log.

        The states are exact: every disc is in free flight after its last event. A log without events has states only
        at its checkpoints.

        Args:
            times: times in increasing order.

        Raises:
            LogError: at a time that the log does not cover, or that is out of order.
        """
        replay: Replay | None = None
        base = -1
        earliest = self.start_time
        for time in times:
            if not earliest <= time <= self.end_time:
                raise LogError(
                    f"{self.path}: no state at time {time:g} (got up to {self.end_time:g}, in increasing order)"
                )
            earliest = time
            nearest = int(self.checkpoints.times.searchsorted(time, "right")) - 1
            if not self.has_events and (nearest < 0 or self.checkpoints.times[nearest] != time):
                raise LogError(
                    f"{self.path}: no state at time {time:g}: a log without events has states only at its checkpoints"
                )
            if replay is None or nearest > base:
                replay, base = self._replay(nearest), nearest
            for block in self.chunks(("time", "disc", *replay.state), replay.row, self.row_at(time, "right")):
                replay.follow(block)
            yield self._file.checked(partial(replay.at, time), f"the state at time {time:g}")

    def to_pandas(
        self,
        what: Literal["events", "flights", "discs", "observables"] = "events",
        *,
        disc: int | None = None,
        t0: float | None = None,
        t1: float | None = None,
        times: Iterable[float] | None = None,
    ) -> "DataFrame":
        """A table of the log as a pandas DataFrame in memory.

        - "events": a row for each event row at times t0 ≤ t < t1, of one disc or of all: time, disc, partner, kind (a
          category: disc, wall, ...), after the event x, y, vx, vy, and with the effect angular_velocity, image_x,
          image_y.
        - "flights": a row for each flight of one disc or of all, cut at `times`, with the columns of `Flights`; kind is
          missing if no event ends the flight.
        - "discs": a row for each disc at each of `times`, by default the start: time, disc, species, radius, mass, and
          the state as above.
        - "observables": a row for each sample at times t0 ≤ t < t1, with a column for each component of `observables`.

        Needs pandas: pip install 'idealgas[notebook]'.

        Args:
            what: name of the table.
            disc: id of a disc.
            t0: start of the window.
            t1: end of the window.
            times: times in increasing order.

        Raises:
            LogError: without pandas, if the log has no events, if it does not cover a time, or if an argument does not
                apply to the table.
        """
        check_choice(self.path, what, {"disc": disc, "t0": t0, "t1": t1, "times": times})
        if what == "events":
            if not self.has_events:
                raise LogError(f"{self.path}: has no events (made with log.events = false)")
            return data_frame(flat_events(self.events(disc, t0, t1), self.columns), {"kind": KIND_NAMES})
        if what == "flights":
            edges = None if times is None else list(times)
            return data_frame(flat_flights(self.flights(edges, discs=disc)), {"kind": KIND_NAMES})
        if what == "discs":
            states = [LogState(self.start_time, **self._start_arrays())] if times is None else self.frames(times)
            return data_frame(flat_discs(self.discs, states, disc), {"species": self.discs.species_names})
        return data_frame([flat_samples(self.observables, self.walls, t0, t1)], {})

    def _replay(self, checkpoint: int) -> Replay:
        if checkpoint >= 0:
            start = self.checkpoints[checkpoint]
        else:
            start = Checkpoint(self.start_time, 0, 0, self._start_arrays(), {})
        return Replay(start, self.columns, self.box, self.periodic, self.gravity)

    def _start_arrays(self) -> dict[str, np.ndarray]:
        """Discs at the start, as in a checkpoint."""
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
