"""One pass over the flights of a log in bounded memory, for any number of tallies.

A tally sums the contributions of flights, and of the events at their ends, in each of B blocks of time; the sums have
shape (B, …). If flights are cut at the edges of the blocks, time averages are exact.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from idealgas.errors import UserError
from idealgas.log import Flights, Log, LogState
from idealgas.log.flights import NO_EVENT, FlightReader
from idealgas.state import Gas
from idealgas.theory.conserved import centre_of_mass_velocity

ReadProgress = Callable[[int, int], None]
"""Function that an analysis calls as progress(done, total) while it reads a log, with numbers of rows or frames."""

FEWEST_BLOCKS, MANY_BLOCKS, MOST_BLOCKS = 32, 512, 8192
PLACES_AT_ONCE = 2**18  # number of positions held in memory at the same time
DISC_BLOCKS = 2**17  # largest number of discs times blocks if there are more than MANY_BLOCKS blocks

VELOCITIES = ("velocity", "end_velocity", "new_velocity")


class Tally(Protocol):
    """Interface of the sums that `stream` collects over the flights of a log."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns of `Flights` that the tally reads."""

    @property
    def cut(self) -> bool:
        """Whether the tally takes all flights, cut at the edges of the blocks.

        Otherwise it takes only flights that end in an event, each as a whole and in the block in which it ends.
        """

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""

    def add(self, flights: Flights) -> None:
        """Add a batch of flights."""

    def finish(self) -> None:
        """Complete the sums after the last flight."""


def stream(
    log: Log, edges: np.ndarray, tallies: Iterable[Tally], progress: Callable[[int, int], None] | None = None
) -> None:
    """Pass the flights between times edges[0] and edges[-1] to all tallies.

    Along axes along which momentum is conserved, velocities are relative to the centre of mass. The function `progress`
    is called as progress(done, total), with numbers of event rows.
    """
    frame = centre_of_mass_velocity(log.scene, log.discs)
    state = log.state_at(edges[0])
    gas = replace(log.discs, position=state.position, velocity=state.velocity - frame)
    tallies = list(tallies)
    reader = FlightReader(log, edges, columns=tuple({name for tally in tallies for name in tally.columns}))

    def moving(flights: Flights) -> Flights:
        if not frame.any():
            return flights
        values_by_name = {name: getattr(flights, name) for name in VELOCITIES}
        relative = {
            id(values): _less(values, frame) for values in values_by_name.values() if values is not None
        }  # arrays may be shared
        moved: dict[str, Any] = {name: relative.get(id(values)) for name, values in values_by_name.items()}
        return flights._replace(**moved)

    for tally in tallies:
        tally.begin(gas, edges)
    cutting = [tally for tally in tallies if tally.cut]
    cutter = FlightReader(log, edges, columns=tuple({name for tally in cutting for name in tally.columns}))
    done, rows = 0, log.row_at(edges[-1], "right") - log.row_at(edges[0], "right")
    for flights in reader.whole():
        whole = moving(reader.batch(flights)) if len(cutting) < len(tallies) else None
        for tally in tallies:
            if whole is not None and not tally.cut:
                tally.add(whole)
        for pieces in cutter.cut(flights) if cutting else ():
            batch = moving(cutter.batch(pieces))
            for tally in cutting:
                tally.add(batch)
        done += len(flights["disc"])
        if progress is not None:
            progress(done, rows)
    for flights in reader.open() if cutting else ():
        for pieces in cutter.cut(flights):
            batch = moving(cutter.batch(pieces))
            for tally in cutting:
                tally.add(batch)
    for tally in tallies:
        tally.finish()


def _less(velocity: np.ndarray, frame: np.ndarray) -> np.ndarray:
    """Return velocities (n, 2) relative to a velocity (2,), component by component, as NumPy is slow for short rows."""
    relative = np.empty_like(velocity)
    for axis in range(2):
        np.subtract(velocity[:, axis], frame[axis], out=relative[:, axis])
    return relative


def add_to(sums: np.ndarray, index: np.ndarray, values: np.ndarray | None = None) -> None:
    """Add values (n,), by default 1 each, to the elements `index` (n,) of the flattened sums."""
    if len(index):
        low = int(index.min())
        added = np.bincount(index - low, values)
        sums.reshape(-1)[low : low + len(added)] += added if values is not None else added.astype(sums.dtype)


def began_in(edges: np.ndarray, start: np.ndarray, block: np.ndarray) -> np.ndarray:
    """Return the blocks in which intervals started, given their start times and the blocks in which they end."""
    return np.minimum(edges.searchsorted(start, "right") - 1, block)


def block_edges(log: Log, start: float | None, end: float | None) -> np.ndarray:
    """Return the boundaries (B + 1,) of blocks of equal width between `start` and `end`, time.

    A block is at least as long as the mean time between two events of a disc, unless this would give too few blocks.
    """
    log.require_events()
    first, last = span(log, start, end)
    rows = log.row_at(last, "right") - log.row_at(first, "right")
    if rows == 0:
        raise UserError(f"{log.path}: no event between t = {exact(first)} and {exact(last)}; {_covered(log)}")
    number = len(log.discs)
    most = min(max(DISC_BLOCKS // number, MANY_BLOCKS), MOST_BLOCKS)
    return np.linspace(first, last, min(max(rows // number, FEWEST_BLOCKS), most) + 1)


def frames(log: Log, times: np.ndarray, progress: Callable[[int, int], None] | None) -> Iterator[LogState]:
    """Yield the states of a log at increasing times; `progress` counts a state after it has been used."""
    for k, state in enumerate(log.frames(times)):
        yield state
        if progress is not None:
            progress(k + 1, len(times))


def span(log: Log, start: float | None, end: float | None) -> tuple[float, float]:
    """Return the start and the end of a window, time, by default those of the log.

    Raises:
        UserError: if the log does not cover the window, or if the end is not after the start.
    """
    first = log.start_time if start is None else start
    last = log.end_time if end is None else end
    if not log.start_time <= first < last <= log.end_time:
        raise UserError(f"{log.path}: empty time window t = {exact(first)} to {exact(last)}: {_covered(log)}")
    return first, last


def exact(number: float) -> str:
    """Return a number as text, with as many digits as are needed to distinguish it from any other."""
    return repr(float(number)).removesuffix(".0")


def _covered(log: Log) -> str:
    return f"the log covers t = {exact(log.start_time)} to {exact(log.end_time)}"


def sample_trajectories(log: Log, times: np.ndarray, discs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return positions (length) and velocities (length/time) of M discs at G increasing times, each (G, M, 2).

    Positions are not wrapped into the box along periodic axes.
    """
    instants, back = np.unique(times, return_inverse=True)
    edges = np.append(instants, instants[-1]) if len(instants) == 1 else instants
    slot = np.full(len(log.discs), -1)
    slot[discs] = np.arange(len(discs))
    places, velocities = np.empty((2, len(edges), len(discs), 2))
    columns = ["disc", "block", "start", "velocity", "position", "displacement", "end_velocity", "kind"]
    if any(log.periodic):
        columns.append("image")
    for flights in log.flights(edges, discs=discs, columns=columns):
        assert flights.position is not None
        place = flights.position if flights.image is None else flights.position + flights.image * np.array(log.box)
        begun = np.flatnonzero(flights.start == edges.take(flights.block))
        at = flights.block[begun], slot[flights.disc[begun]]
        places[at], velocities[at] = place[begun], flights.velocity[begun]
        ended = np.flatnonzero((flights.kind == NO_EVENT) & (flights.block == len(edges) - 2))
        last = slot[flights.disc[ended]]
        places[-1, last], velocities[-1, last] = (place + flights.displacement)[ended], flights.end_velocity[ended]
    return places[back], velocities[back]


def trajectories(
    log: Log, times: np.ndarray, progress: Callable[[int, int], None] | None = None
) -> Iterator[tuple[slice, np.ndarray, np.ndarray]]:
    """Yield positions and velocities of all discs, relative to the centre of mass, at increasing times (G,).

    To limit memory, the times are processed in groups. Each item consists of a slice of g of the times, positions
    (length), which are not wrapped into the box, and velocities (length/time), each (g, N, 2). The function `progress`
    is called as progress(done, total), with numbers of times.
    """
    drift, discs = centre_of_mass_velocity(log.scene, log.discs), np.arange(len(log.discs))
    at_once = max(PLACES_AT_ONCE // len(discs), 1)
    for first in range(0, len(times), at_once):
        now = times[first : first + at_once]
        places, velocities = sample_trajectories(log, now, discs)
        yield slice(first, first + len(now)), places - drift * now[:, None, None], velocities - drift
        if progress is not None:
            progress(first + len(now), len(times))
