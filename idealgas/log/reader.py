"""Read the log of a run, which may be complete, still running, interrupted or killed."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property, partial, wraps
from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING, Concatenate, Literal, ParamSpec, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from idealgas.errors import plain
from idealgas.locks import is_locked
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
from idealgas.log.history import LogHistory
from idealgas.log.log_file import ATTEMPTS, PAUSE, LogFile
from idealgas.log.replay import LogState

if TYPE_CHECKING:
    from pandas import DataFrame


class Samples(Mapping[str, tuple[np.ndarray, np.ndarray]]):
    """Times and values of the samples, by name of the observable; each is read from the file on first access."""

    def __init__(self, file: LogFile, names: Sequence[str], times: Callable[[int], np.ndarray], step: int = 1) -> None:
        """Select every `step`-th sample of the named observables; `times` is a function that reads their times."""
        self._file, self._names, self._read_times, self._step = file, tuple(names), times, step
        self._read: dict[str, tuple[np.ndarray, np.ndarray]] = {}

    def thinned(self, most: int) -> "Samples":
        """Return at most `most` of these samples, evenly spaced, starting with the first."""
        return Samples(self._file, self._names, self._read_times, max(1, -(-self._file.rows("observables") // most)))

    def __getitem__(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        if name not in self._read:
            if name not in self._names:
                raise DamageError(self._file.path, f"observables: has no {name}")
            self._read[name] = self.times, self._file.column(f"observables/{name}/value", self._step)
        return self._read[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    @cached_property
    def times(self) -> np.ndarray:
        """Times of the samples, (P,)."""
        return self._read_times(self._step)


def open_log(path: str | os.PathLike[str]) -> "Log":
    """Open the log of a run for reading. Use the log in a `with` statement, or call its `close` method at the end.

    Args:
        path: path of the log.

    Raises:
        LogError: if the file is missing, damaged or not a log of idealgas. As most of the file is read on demand, any
            method of `Log` may raise it, too.
    """
    for _ in range(ATTEMPTS):
        before = _last_change(path)
        try:
            return Log(LogFile(Path(path)))
        except LogError:
            if not is_locked(Path(path)) and _last_change(path) == before:
                raise
            sleep(PAUSE)  # a run may just have ended, or may be removing rows in order to resume the log
    return Log(LogFile(Path(path)))


def _last_change(path: str | os.PathLike[str]) -> tuple[int, ...]:
    """Return the inode, the size and the modification time of a file; an empty tuple if the file is missing."""
    try:
        status = os.stat(path)
    except OSError:
        return ()
    return status.st_ino, status.st_size, status.st_mtime_ns


class Log(LogHistory):
    """The log of a run, open for reading; a context manager that closes the file. Use `open_log` to create one.

    `len(log)` is the number of event rows: two for each collision of two discs, and one for any other event.
    `print(log)` shows the scene, the state of the run and the file. Energies and temperatures are in units of
    mass·length²/time², with Boltzmann's constant equal to 1. Methods and properties raise LogError if the data that
    they require are damaged.

    Attributes:
        path: path of the file.
        complete: whether the run reached its end.
        unclosed: whether the file is not closed, because it is still being written (see `live`) or its run was killed.
        has_events: whether the log has event rows.
        box: (Lx, Ly), length; the origin is the lower left corner.
        periodic: whether the box is periodic along x and along y.
        gravity: (gx, gy), length/time².
        start_time: 0.
    """

    @property
    def run_state(self) -> str:
        """State of the run: "complete", "running", "not closed (crash?)" or "interrupted"."""
        if self.complete:
            return "complete"
        if self.unclosed:
            return "running" if self.live else "not closed (crash?)"
        return "interrupted"

    def __str__(self) -> str:
        """Return three lines: the scene and its discs; the time span, events and state of the run; and the file."""
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

    @cached_property
    def observables(self) -> "Samples":
        """Samples taken during the run: times (P,) and values (P,) or (P, components), by name, read on first access.

        Every log has kinetic_energy, momentum, energy (of the discs), overlap (deepest overlap of two discs, relative
        to the sum of their radii), outside (largest distance by which a disc extends beyond a reflecting side, in
        diameters), and the numbers of events, disc_collisions, wall_hits and trials since the start. Effects add
        rotational_energy, potential_energy, piston_position and piston_velocity (of each piston), wall_energy (received
        from each wall since the start), dissipated_energy (lost since the start, first in collisions between discs,
        then at each wall), thermostat_collisions and bath_energy.

        With `log.pressure`, samples also contain the sums that are described in idealgas/log/README.md: kinetic_flow,
        collision_flow, wall_virial, face_normal_impulse, face_tangential_impulse, face_hits and, in mixtures,
        pair_collisions; with `log.heat_flow` also kinetic_heat_flow and collision_heat_flow.
        """
        names = [name.partition("/")[0] for name in self._file.names("observables") if name.endswith("/value")]
        return Samples(self._file, names, partial(self._sample_times, "observables"))

    @cached_property
    def snapshot_times(self) -> np.ndarray:
        """Times of the snapshots, (S,); `log.snapshot_every` adds snapshots to the file, in the layout of H5MD."""
        return self._sample_times("particles", 1)

    def flights(
        self, edges: ArrayLike | None = None, *, discs: ArrayLike | None = None, columns: Sequence[str] | None = None
    ) -> Iterator[Flights]:
        """Yield the flights of discs from event to event, in batches.

        A flight contains the state of a disc at the start of the flight and the event at its end; `Flights` describes
        the columns. The flights of a disc cover the time from the first edge to the last and are cut into pieces at the
        edges in between. A batch has at most 131 072 pieces, unless a single flight has more.

        Args:
            edges: (B + 1,), times in increasing order; by default the start and the end of the log.
            discs: ids of the discs to include; all by default.
            columns: names of the columns to compute; by default all columns of the log, which takes longer.

        Raises:
            LogError: if the log has no events, if a column or a disc does not exist, or if the log does not cover the
                times of the edges.
        """
        return FlightReader(self, edges, discs, columns).batches()

    def to_pandas(
        self,
        table: Literal["events", "flights", "discs", "observables"] = "events",
        *,
        disc: int | None = None,
        t0: float | None = None,
        t1: float | None = None,
        times: Iterable[float] | None = None,
    ) -> "DataFrame":
        """Return a table of the log as a pandas DataFrame.

        - "events": one row per event row of one disc or all discs at times t0 ≤ t < t1, with time, disc, partner, kind
          (a category: disc, wall, ...) and the state after the event: x, y, vx, vy and, if the scene has rotation or
          periodic sides, angular_velocity or image_x and image_y.
        - "flights": one row per flight of one disc or all discs, cut at `times`, with the columns of `Flights`; kind is
          missing if the flight does not end with an event.
        - "discs": one row per disc at each of `times`, by default the start, with time, disc, species, radius, mass and
          the state as above.
        - "observables": one row per sample at times t0 ≤ t < t1, with a column for each component of `observables`.

        Requires pandas: .venv/bin/pip install -e ".[notebook]".

        Args:
            table: name of the table.
            disc: id of a disc; all discs by default.
            t0: start of the window; by default the start of the log.
            t1: end of the window; by default the end of the log.
            times: times in increasing order.

        Raises:
            LogError: if pandas is missing, if the table requires events and the log has none, if the log does not cover
                a time, or if an argument does not apply to the table.
        """
        check_choice(self.path, table, {"disc": disc, "t0": t0, "t1": t1, "times": times})
        if table == "events":
            self.require_events()
            return data_frame(flat_events(self.events(disc, t0, t1), self.columns), {"kind": KIND_NAMES})
        if table == "flights":
            edges = None if times is None else list(times)
            names = {"kind": KIND_NAMES, "species": self.discs.species_names}
            return data_frame(flat_flights(self.flights(edges, discs=disc)), names)
        if table == "discs":
            states = [LogState(self.start_time, **self._start_arrays())] if times is None else self.frames(times)
            return data_frame(flat_discs(self.discs, states, disc), {"species": self.discs.species_names})
        return data_frame([flat_samples(self.observables, self.walls, t0, t1)], {})


Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")


def takes_path(
    function: Callable[Concatenate[Log, Parameters], Result],
) -> Callable[Concatenate[Log | str | os.PathLike[str], Parameters], Result]:
    """Decorate a function whose first argument is a log, so that it also accepts the path of a log."""

    @wraps(function)
    def opening(log: Log | str | os.PathLike[str], *args: Parameters.args, **named: Parameters.kwargs) -> Result:
        if isinstance(log, Log):
            return function(log, *args, **named)
        with open_log(log) as opened:
            return function(opened, *args, **named)

    return opening
