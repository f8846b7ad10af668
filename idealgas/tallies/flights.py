"""Time averages of velocities, and numbers of discs in bins of the box, from flights cut at the edges of blocks."""

from collections.abc import Iterator

import numpy as np

from idealgas.columns import WALL_HITS, Kind
from idealgas.log import Flights
from idealgas.log.flights import NO_EVENT
from idealgas.physics.motion import path_length
from idealgas.state import Gas
from idealgas.tallies.ballistic import (
    changes_during_flight,
    integral_over_fall,
    time_at_value,
    turning_time,
    value_during_flight,
    velocity_quantity,
)
from idealgas.tallies.stream import add_to

VELOCITY_QUANTITIES = ("speed", "vx", "vy", "energy")

AT_ONCE = 2**13
"""Number of falls whose passages through the bins of a histogram are held in memory at the same time."""

_COLLISION, _WALL_HIT, _OTHER = range(3)
_SORT = np.full(NO_EVENT + 1, _OTHER)  # class of an event, by its kind
_SORT[Kind.DISC] = _COLLISION
_SORT[list(WALL_HITS)] = _WALL_HIT


class Moments:
    """Time integrals of velocity moments, summed over the discs of each species, and event counts in each block.

    Attributes:
        flights: (B, S, 3), integrals of |v|, m vx² and m vy² over time for B blocks and S species.
        events: (B, 2), numbers of pair collisions and of wall hits.
    """

    columns = ("disc", "block", "start", "end", "kind", "velocity")
    cut = True

    def __init__(self, gravity: tuple[float, float] = (0.0, 0.0)) -> None:
        """Set the acceleration `gravity`, length/time²; unless it is 0, flights are parabolas."""
        self.gravity = gravity

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        self._species, self._mass = gas.species.astype(np.intp), gas.mass
        self._sums = np.zeros((3, len(edges) - 1, len(gas.species_names)))
        self._counts = np.zeros((len(edges) - 1, 3), np.int64)

    def add(self, flights: Flights) -> None:
        """Add a batch of flights."""
        add_to(self._counts, flights.block * 3 + _SORT.take(flights.kind))
        index = flights.block * self._sums.shape[2] + self._species.take(flights.disc)
        mass, time = self._mass.take(flights.disc), flights.end - flights.start
        vx, vy = flights.velocity.T
        if any(self.gravity):
            integrals = _moments_of_fall(mass, vx, vy, self.gravity, time)
        else:
            squares = vx * vx, vy * vy
            weight = mass * time
            integrals = time * np.sqrt(squares[0] + squares[1]), weight * squares[0], weight * squares[1]
        for sums, values in zip(self._sums, integrals, strict=True):
            add_to(sums, index, values)

    def finish(self) -> None:
        """Set the attributes from the sums."""
        self.flights = np.moveaxis(self._sums, 0, 2)
        self.events = self._counts[:, [_COLLISION, _WALL_HIT]] // [2, 1]  # a collision ends two flights


def _moments_of_fall(
    mass: np.ndarray, vx: np.ndarray, vy: np.ndarray, gravity: tuple[float, float], t: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Return the integrals of the moments over parabolic flights of duration t that start at velocity (vx, vy)."""
    gx, gy = gravity
    return (
        path_length(vx, vy, gravity, t),
        mass * t * (vx * vx + t * gx * (vx + t * gx / 3.0)),
        mass * t * (vy * vy + t * gy * (vy + t * gy / 3.0)),
    )


class VelocityHistogram:
    """Time-weighted histogram of a velocity quantity, and its values for sampled discs at the edges between blocks.

    Attributes:
        counts: (B, S, bins + 2), time that discs spent below the bins, in each bin, and above the bins.
        sums: (B, S), integral of the quantity over time, summed over discs.
        snapshots: (B - 1, M), values for the M `sampled` discs at the edges between blocks.
    """

    columns = ("disc", "block", "start", "end", "velocity")
    cut = True

    def __init__(
        self,
        quantity: str,
        low: np.ndarray,
        high: np.ndarray,
        bins: int,
        sampled: np.ndarray,
        gravity: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Set the quantity, the range of the bins for each species, and the discs whose values are sampled.

        Args:
            quantity: name of the quantity, one of VELOCITY_QUANTITIES.
            low: (S,), lower end of the bins, in the unit of the quantity.
            high: (S,), upper end of the bins.
            bins: number of bins.
            sampled: (M,), indices of the sampled discs.
            gravity: acceleration between events, length/time².
        """
        self.gravity = gravity
        self.quantity = VELOCITY_QUANTITIES.index(quantity)
        self.low, self.per_unit, self.bins = low, bins / (high - low), bins
        self.sampled = sampled

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        self.edges = edges
        self.counts = np.zeros((len(edges) - 1, len(gas.species_names), self.bins + 2))
        self.sums = np.zeros((len(edges) - 1, len(gas.species_names)))
        self.snapshots = np.zeros((len(edges) - 2, len(self.sampled)))
        self._slot = np.full(len(gas), -1)
        self._slot[self.sampled] = np.arange(len(self.sampled))
        self._species, self._mass = gas.species.astype(np.intp), gas.mass

    def add(self, flights: Flights) -> None:
        """Add a batch of flights."""
        time, (vx, vy) = flights.end - flights.start, flights.velocity.T
        species, mass = self._species.take(flights.disc), self._mass.take(flights.disc)
        place = flights.block * len(self.low) + species
        value = velocity_quantity(self.quantity, mass, vx, vy)
        if changes_during_flight(self.quantity, self.gravity):
            add_to(self.sums, place, integral_over_fall(self.quantity, mass, vx, vy, self.gravity, time))
            for first in range(0, len(time), AT_ONCE):
                chunk = slice(first, first + AT_ONCE)
                self._spread(place[chunk], species[chunk], mass[chunk], vx[chunk], vy[chunk], time[chunk])
        else:
            add_to(self.sums, place, value * time)
            add_to(self.counts, place * (self.bins + 2) + self._bin_of(value, species), time)
        slot = self._slot.take(flights.disc)
        at_edge = np.flatnonzero((slot >= 0) & (flights.block > 0) & (flights.start == self.edges.take(flights.block)))
        self.snapshots[flights.block[at_edge] - 1, slot[at_edge]] = value[at_edge]

    def finish(self) -> None:
        """Do nothing: the sums are complete."""

    def _bin_of(self, value: np.ndarray, species: np.ndarray) -> np.ndarray:
        return bin_of(value, self.low.take(species), self.per_unit.take(species), self.bins)

    def _spread(
        self,
        place: np.ndarray,
        species: np.ndarray,
        mass: np.ndarray,
        vx: np.ndarray,
        vy: np.ndarray,
        duration: np.ndarray,
    ) -> None:
        """Add the times that a quantity spends in each bin during falls (n,), before and after its minimum."""
        turn = np.clip(turning_time(self.quantity, vx, vy, self.gravity), 0.0, duration)
        for rises, start, end in ((False, np.zeros_like(turn), turn), (True, turn, duration)):
            first, last = (
                self._bin_of(value_during_flight(self.quantity, mass, vx, vy, self.gravity, time), species)
                for time in (start, end)
            )
            steps = np.abs(last - first)
            k = np.repeat(np.arange(len(steps)), steps + 1)  # index of the fall to which each stay in a bin belongs
            number = np.arange(len(k)) - (np.cumsum(steps + 1) - steps - 1)[k]
            up = last[k] > first[k]
            b = first[k] + np.where(up, number, -number)
            edge = self.low[species[k]] + np.where(up, b, b - 1) / self.per_unit[species[k]]
            met = time_at_value(self.quantity, mass[k], edge, np.full(len(k), rises), vx[k], vy[k], self.gravity)
            until = np.where(number == steps[k], end[k], np.clip(met, start[k], end[k]))
            since = np.where(number == 0, start[k], np.roll(until, 1))
            add_to(self.counts, place[k] * (self.bins + 2) + b, until - since)


def bin_of(value: np.ndarray, low: np.ndarray | float, per_unit: np.ndarray | float, bins: int) -> np.ndarray:
    """Return the bin index of each value: 0 below the range, 1 to `bins` inside the range, bins + 1 above it."""
    place = (value - low) * per_unit
    return np.where(place < 0, 0, np.clip(place, 0, bins).astype(np.intp) + 1)


class DensityBins:
    """Numbers of discs of each species in bins of the box at the end of each block of time.

    Attributes:
        discs: (B, S, 2, bins), numbers for B blocks and S species, in bins along x and along y.
    """

    columns = ("disc", "block", "start", "kind", "position", "end_position")
    cut = True

    def __init__(self, bins: int) -> None:
        """Set the number of bins along each axis."""
        self.bins = bins

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        self.edges = edges
        self.discs = np.zeros((len(edges) - 1, len(gas.species_names), 2, self.bins))
        self._per_length = self.bins / np.array(gas.box)
        self._species = gas.species.astype(np.intp)

    def add(self, flights: Flights) -> None:
        """Add flights; at the end of each block but the last, a cut flight of each disc begins."""
        for chosen, block, position in self._at_edges(flights):
            place = np.clip(position * self._per_length, 0, self.bins - 1).astype(np.intp)
            first = (block * self.discs.shape[1] + self._species[flights.disc[chosen]]) * 2
            for axis in range(2):
                add_to(self.discs, (first + axis) * self.bins + place[:, axis])

    def finish(self) -> None:
        """Do nothing: the sums are complete."""

    def _at_edges(self, flights: Flights) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Yield the flights that begin or end at the end of a block, these blocks, and the positions at that time."""
        assert flights.position is not None
        assert flights.end_position is not None
        later = np.flatnonzero((flights.block > 0) & (flights.start == self.edges.take(flights.block)))
        yield later, flights.block[later] - 1, flights.position[later]
        last = np.flatnonzero((flights.kind == NO_EVENT) & (flights.block == len(self.discs) - 1))
        yield last, flights.block[last], flights.end_position[last]
