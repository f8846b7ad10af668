"""Flights: the motion of each disc between two successive events of the disc, computed in bounded memory.

An event row contains the state of a disc after an event. A flight also contains the state before the event, which
follows from the disc's previous event. A single pass over the rows joins the two.
"""

from collections.abc import Collection, Iterable, Iterator
from itertools import chain
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike

from idealgas.columns import BLOCK, Column, Kind
from idealgas.log.errors import LogError
from idealgas.log.history import LogHistory
from idealgas.log.join import Arrays, Join, whole_pairs
from idealgas.physics.motion import path_length, position_after, velocity_after
from idealgas.physics.periodic import wrapped

BATCH = 2 * BLOCK
"""Largest number of pieces of flights in a batch, unless a single flight has more."""

NO_EVENT = 255
"""Kind of a flight that does not end with an event, because it is cut or still in progress at the last edge."""
NOBODY = -(2**31)
"""Value of `partner` for a flight that does not end with an event."""

FLIGHT_COLUMNS = (
    Column("disc", "u4"),
    Column("species", "u2"),
    Column("block", "i8"),
    Column("start", "f8", (), "time"),
    Column("end", "f8", (), "time"),
    Column("kind", "u1"),
    Column("partner", "i4"),
    Column("ends_in_collision", "?"),
    Column("velocity", "f8", (2,), "length/time", parts=("vx", "vy")),
    Column("end_velocity", "f8", (2,), "length/time", parts=("end_vx", "end_vy")),
    Column("new_velocity", "f8", (2,), "length/time", parts=("new_vx", "new_vy")),
    Column("displacement", "f8", (2,), "length", parts=("displacement_x", "displacement_y")),
    Column("path", "f8", (), "length"),
    Column("position", "f8", (2,), "length", parts=("x", "y")),
    Column("end_position", "f8", (2,), "length", parts=("end_x", "end_y")),
    Column("image", "i4", (2,), parts=("image_x", "image_y")),
    Column("angular_velocity", "f8", (), "1/time"),
    Column("new_angular_velocity", "f8", (), "1/time"),
)
"""All columns that flights can have, in the order of the fields of `Flights`."""

_NEEDS: dict[str, tuple[str, ...]] = {
    "ends_in_collision": ("kind",),
    "path": ("velocity",),
    "end_velocity": ("velocity",),
    "new_velocity": ("velocity",),
    "displacement": ("velocity",),
    "position": ("velocity",),
    "end_position": ("position", "velocity"),
    "image": ("position", "velocity"),
    "new_angular_velocity": ("angular_velocity",),
}
"""Columns from which a column is computed where a flight is cut at an edge, by name of the column."""

_READ = {
    "kind": "kind",
    "partner": "partner",
    "velocity": "velocity",
    "new_velocity": "velocity",
    "position": "position",
    "end_position": "position",
    "image": "image",
    "angular_velocity": "angular_velocity",
    "new_angular_velocity": "angular_velocity",
}
"""Event column that contains the values of a flight column, by name of the flight column."""

_STATE = {"position", "velocity", "image", "angular_velocity"}
"""Columns that describe the state at the start of a flight."""


class Flights(NamedTuple):
    """Flights of discs, ordered by the events at their ends; flights still in progress at the last edge come last.

    The two flights that end in a collision of two discs are in the same batch, with the flight of the smaller id first;
    only pieces of the second flight lie between their last pieces. The pieces of a flight are consecutive. A column
    that was not requested is None. Columns may share memory, so do not modify them.

    Attributes:
        disc: (n,) u4, id of the disc.
        species: (n,) u2, number of the disc's species.
        block: (n,) i8, number of the interval between two edges, from 0; an event at an edge belongs to the
            interval that ends there.
        start: (n,) f8, time of the disc's previous event, or of the edge at which the piece begins.
        end: (n,) f8, time of the event or edge at the end of the flight.
        kind: (n,) u1, `Kind` of the event at the end of the flight, or NO_EVENT.
        partner: (n,) i4, id of the other disc in this event, -1 - k for wall k, BATH, OUTSIDE, or NOBODY.
        ends_in_collision: (n,) bool, whether the flight ends in a collision with another disc.
        velocity: (n, 2) f8, velocity at the start, length/time.
        end_velocity: (n, 2) f8, velocity at the end, just before the event, length/time; equal to `velocity` if there
            is no gravity.
        new_velocity: (n, 2) f8, velocity just after the event, length/time; equal to `end_velocity` if there is no
            event.
        displacement: (n, 2) f8, displacement from start to end, unwrapped across periodic sides, length.
        path: (n,) f8, length of the path from start to end, which is part of a parabola if there is gravity.
        position: (n, 2) f8, position at the start, inside the box, length; None if discs have no positions.
        end_position: (n, 2) f8, position at the end, inside the box, length; None if discs have no positions.
        image: (n, 2) i4, numbers of box lengths to add to `position` to unwrap it; None without periodic sides.
        angular_velocity: (n,) f8, angular velocity during the flight, 1/time; None if discs do not spin.
        new_angular_velocity: (n,) f8, angular velocity after the event, 1/time; None if discs do not spin.
    """

    disc: np.ndarray
    species: np.ndarray
    block: np.ndarray
    start: np.ndarray
    end: np.ndarray
    kind: np.ndarray
    partner: np.ndarray
    ends_in_collision: np.ndarray
    velocity: np.ndarray
    end_velocity: np.ndarray
    new_velocity: np.ndarray
    displacement: np.ndarray
    path: np.ndarray
    position: np.ndarray | None = None
    end_position: np.ndarray | None = None
    image: np.ndarray | None = None
    angular_velocity: np.ndarray | None = None
    new_angular_velocity: np.ndarray | None = None

    @classmethod
    def joined(cls, batches: Iterable["Flights"]) -> "Flights":
        """Join one or more batches of flights."""
        columns: Iterable[Any] = zip(*batches, strict=True)
        return cls(*(cast(Any, None if column[0] is None else np.concatenate(column)) for column in columns))


def flight_columns(events: Collection[str]) -> tuple[Column, ...]:
    """Return the columns that flights of a log can have, given the names of its event columns."""
    return tuple(column for column in FLIGHT_COLUMNS if _read_for(_made_for([column.name])) <= set(events))


def _made_for(columns: Collection[str]) -> set[str]:
    """Return the names of the given columns and of all columns from which they are computed."""
    return {source for name in columns for source in (name, *_NEEDS.get(name, ()))}


def _read_for(made: set[str]) -> set[str]:
    """Return the names of the event columns that must be read to compute the given columns of flights."""
    return {_READ[name] for name in made if name in _READ}


class FlightReader:
    """Reader of the flights in a log between the first and the last edge, cut at the edges in between.

    Most callers need only `batches`. The other methods are the steps of `batches`; with them, a single pass can sum
    over whole flights as well as over pieces. These methods return columns by name, including the columns that are
    needed to compute the requested columns where a flight is cut.
    """

    def __init__(
        self,
        log: LogHistory,
        edges: ArrayLike | None = None,
        discs: ArrayLike | None = None,
        columns: Collection[str] | None = None,
    ) -> None:
        """Check the arguments, which are those of `Log.flights`. Raises LogError if they are invalid."""
        log.require_events()
        known = [column.name for column in flight_columns(log.columns)]
        if unknown := [name for name in columns or () if name not in known]:
            raise LogError(f"{log.path}: its flights have no {' and no '.join(unknown)} (allowed: {', '.join(known)})")
        times = np.array([log.start_time, log.end_time] if edges is None else edges, float)
        if times.ndim != 1 or len(times) < 2 or not (np.diff(times) >= 0).all():
            raise LogError(f"{log.path}: edges of flights must be two or more times in increasing order")
        if not log.start_time <= times[0] <= times[-1] <= log.end_time:
            got = f"t = {times[0]:g} to {times[-1]:g} (allowed {log.start_time:g} to {log.end_time:g})"
            raise LogError(f"{log.path}: no flights from {got}")
        self._discs = None if discs is None else np.unique(np.asarray(discs))
        if self._discs is not None and not np.isin(self._discs, np.arange(len(log.discs))).all():
            raise LogError(f"{log.path}: flights of a disc that does not exist (allowed: 0 to {len(log.discs) - 1})")
        self._log, self._edges = log, times
        self._columns = set(known if columns is None else columns)
        self._made = _made_for(self._columns)
        self._read = ("time", "disc", *sorted(_read_for(self._made) | ({"kind"} if log.escapes else set())))
        self._falls = log.has_gravity

    def batches(self) -> Iterator[Flights]:
        """Yield all flights, cut at the edges, in batches."""
        for flights in chain(self.whole(), self.open()):
            for pieces in self.cut(flights):
                yield self.batch(pieces)

    def whole(self) -> Iterator[Arrays]:
        """Yield the uncut flights that end with events, in batches; a flight belongs to the block in which it ends."""
        log, (first, last) = self._log, self._edges[[0, -1]]
        state = log.state_at(first)
        self._join, self._left = Join(state, self._read), ~state.inside
        for rows in whole_pairs(log.chunks(self._read, log.row_at(first, "right"), log.row_at(last, "right"))):
            if self._discs is not None:
                chosen = np.flatnonzero(np.isin(rows["disc"], self._discs))
                rows = {name: values[chosen] for name, values in rows.items()}
            if log.escapes:
                self._left[rows["disc"][rows["kind"] == Kind.ESCAPED]] = True
            if len(rows["disc"]):
                yield self._flights(self._join.pass_on(rows), rows["time"], rows)

    def open(self) -> Iterator[Arrays]:
        """Yield the uncut flights that are still in progress at the last edge, in batches; to be called after `whole`.

        There is one such flight for each disc that has not left the gas.
        """
        present = np.flatnonzero(~self._left)
        present = present if self._discs is None else np.intersect1d(present, self._discs)
        for ids in np.split(present, range(BATCH, len(present), BATCH)):
            yield self._flights(self._join.states(ids), np.full(len(ids), self._edges[-1]), None)

    def cut(self, flights: Arrays) -> Iterator[Arrays]:
        """Cut a batch of flights at the edges, and yield the pieces in batches, with the columns of this reader."""
        kept = {"disc", "block", "start", "end", "partner", *self._made}
        flights = {name: values for name, values in flights.items() if name in kept}
        edges, last = self._edges, flights["block"]
        before = np.flatnonzero(flights["start"] < edges[last])
        if len(before) == 0:
            yield flights
            return
        first = last.copy()
        first[before] = edges.searchsorted(flights["start"][before], "right") - 1
        pieces = last - first + 1
        done, stop = np.append(0, np.cumsum(pieces)), 0
        pairs = "partner" in flights and self._discs is None
        while stop < len(pieces):
            start = stop
            stop = max(int(done.searchsorted(done[start] + BATCH, "right")) - 1, start + 1)
            if pairs and flights["disc"][stop - 1] < flights["partner"][stop - 1]:  # do not separate a pair of flights
                stop += 1 if stop - 1 == start else -1
            rows = slice(start, stop)
            yield self._pieces({name: values[rows] for name, values in flights.items()}, first[rows], pieces[rows])

    def batch(self, flights: Arrays) -> Flights:
        """Return a batch of flights with the requested columns."""
        columns = dict(flights)
        if "species" in self._made:
            columns["species"] = self._log.discs.species[flights["disc"]]
        if "ends_in_collision" in self._made:
            columns["ends_in_collision"] = flights["kind"] == Kind.DISC
        if not self._falls and "end_velocity" in self._made:
            columns["end_velocity"] = flights["velocity"]
        delay, gravity = flights["end"] - flights["start"], self._gravity(flights["start"])
        if "displacement" in self._made:
            columns["displacement"] = position_after(0.0, flights["velocity"], gravity, delay[:, None])
        if "path" in self._made:
            vx, vy = flights["velocity"].T
            columns["path"] = path_length(vx, vy, None if gravity is None else gravity.T, delay)
        return Flights(*(cast(Any, columns[name] if name in self._columns else None) for name in Flights._fields))

    def _flights(self, state: Arrays, end: np.ndarray, rows: Arrays | None) -> Arrays:
        """Return uncut flights as columns by name.

        Args:
            state: states of the discs at the starts of the flights, as columns by name.
            end: (n,), times at which the flights end.
            rows: event rows at the ends of the flights; None if the flights are still in progress at the last edge.
        """
        start, made = state["time"], self._made
        columns = {"disc": state["disc"], "block": self._block_of(end), "start": start, "end": end}
        columns |= {name: state[name] for name in _STATE & made}
        if self._falls and "end_velocity" in made:
            columns["end_velocity"] = self._velocity(state["velocity"], start, end)
        if rows is not None:
            return columns | {name: rows[source] for name, source in _READ.items() if name in made - _STATE}
        if "end_position" in made:
            columns["end_position"], _ = self._position(state["position"], state["velocity"], start, end)
        if "new_velocity" in made:
            columns["new_velocity"] = self._velocity(state["velocity"], start, end)
        if "new_angular_velocity" in made:
            columns["new_angular_velocity"] = state["angular_velocity"]
        none = {"kind": np.full(len(end), NO_EVENT, "u1"), "partner": np.full(len(end), NOBODY, "i4")}
        return columns | {name: values for name, values in none.items() if name in made}

    def _pieces(self, flights: Arrays, first: np.ndarray, pieces: np.ndarray) -> Arrays:
        """Cut flights into pieces. first: (n,), block of each flight's first piece; pieces: (n,), numbers of pieces."""
        source = np.repeat(np.arange(len(pieces)), pieces)
        opening = np.cumsum(pieces) - pieces
        columns = {name: values.take(source, axis=0) for name, values in flights.items()}
        columns["block"] = (first - opening).take(source) + np.arange(len(source))
        inner = np.ones(len(source), bool)
        inner[opening] = False
        later = np.flatnonzero(inner)  # pieces that begin at an edge, where the previous piece ends
        earlier, edge = later - 1, self._edges[columns["block"][later]]
        start = columns["start"][later]
        now = {name: columns[name][later] for name in _STATE & columns.keys()}
        if "position" in now:
            now["position"], boxes = self._position(now["position"], now["velocity"], start, edge)
            if "image" in now:
                now["image"] += boxes.astype(np.int32)
        if "velocity" in now:
            now["velocity"] = self._velocity(now["velocity"], start, edge)
        for name, values in {"start": edge, **now}.items():
            columns[name][later] = values
        ends: dict[str, Any] = {"end": edge, "kind": NO_EVENT, "partner": NOBODY}
        ends |= {f"{when}_{name}": values for name, values in now.items() for when in ("end", "new")}
        for name in ends.keys() & columns.keys():
            columns[name][earlier] = ends[name]
        return columns

    def _block_of(self, times: np.ndarray) -> np.ndarray:
        """Return the block of each time, for times after the first edge that do not decrease."""
        inner = self._edges[1:-1]
        low, high = inner.searchsorted(times[[0, -1]]) if len(times) else (0, 0)
        return np.asarray(low + inner[low:high].searchsorted(times))

    def _gravity(self, start: np.ndarray) -> np.ndarray | None:
        """Return the accelerations, (n, 2) or (2,), in flights that start at times (n,); None without gravity."""
        return self._log.gravity_at(start) if self._falls else None

    def _velocity(self, velocity: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return the velocities (n, 2) at times `end`, given the velocities (n, 2) at times `start`."""
        gravity = self._gravity(start)
        return velocity if gravity is None else velocity_after(velocity, gravity, (end - start)[:, None])

    def _position(
        self, position: np.ndarray, velocity: np.ndarray, start: np.ndarray, end: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the positions at times `end`, wrapped into the box, and the numbers of box lengths crossed, (n, 2)."""
        place = position_after(position, velocity, self._gravity(start), (end - start)[:, None])
        boxes = np.zeros_like(place)
        for axis in np.flatnonzero(self._log.wrapped_axes):
            place[:, axis], boxes[:, axis] = wrapped(place[:, axis], self._log.box[axis])
        return place, boxes
