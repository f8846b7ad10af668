"""Impact parameters of collisions between discs, and numbers of collisions of a disc in a given time."""

import numpy as np

from idealgas.columns import Kind
from idealgas.log import Flights
from idealgas.state import Gas
from idealgas.tallies.impacts import contacts
from idealgas.tallies.intervals import Intervals
from idealgas.tallies.stream import MOST_BLOCKS

POWERS = 4
"""Number of power sums Σ n^p; the first one, for p = 0, is the number of discs."""


class ImpactParameters(Intervals):
    """Impact parameters |b| over the sum of radii; b is the offset of the centres normal to the relative velocity."""

    columns = ("disc", "block", "kind", "partner", "end_velocity", "end_position")

    def __init__(self, periodic: tuple[bool, ...], bins: int, stride: int, most_samples: int) -> None:
        """Set whether x and y are periodic; the other arguments are those of `Intervals`."""
        super().__init__(np.ones(1), bins, stride, most_samples)
        self._periodic = periodic

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        self._make_sums(edges)
        self._box = gas.box

    def add(self, flights: Flights) -> None:
        """Add a batch of flights."""
        second, apart = contacts(flights, self._box, self._periodic)
        (x, y), (vx, vy) = apart.T, (flights.end_velocity[second] - flights.end_velocity[second - 1]).T
        passing = np.abs(x * vy - y * vx) / (np.hypot(x, y) * np.hypot(vx, vy))
        self._put(passing, flights.block[second], np.zeros(len(second), np.intp))


class CollisionCounts:
    """Numbers of collisions of each disc with other discs in successive intervals of time t, by species, and a sample.

    Successive intervals are merged into G ≤ MOST_BLOCKS groups with the same number of intervals each.

    Attributes:
        begins: (G,), starts of the groups, time.
        counts: (G, S, bins + 2), histogram of the number of collisions: a column of zeros, the numbers of discs with 0
            to bins - 1 collisions, and the number of discs with more.
        sums: (G, S, POWERS), Σ n^p over discs and intervals, for powers p from 0.
        sample: (n,), sampled numbers of collisions.
        sample_index: (n,), index of the group of each sampled number.
        sample_species: (n,), species of the disc of each sampled number.
    """

    columns = ("disc", "end", "kind")
    cut = False

    def __init__(self, time: float, bins: int, stride: int) -> None:
        """Set the interval t, the number of bins, and the stride: each interval samples every `stride`-th disc."""
        self.time, self.bins, self.stride = time, bins, stride

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        times, species = int((edges[-1] - edges[0]) / self.time), len(gas.species_names)
        self._together = max(-(-times // MOST_BLOCKS), 1)
        number = times // self._together
        self._start, self._times = edges[0], number * self._together
        self.begins = self._start + self.time * self._together * np.arange(number)
        self.counts = np.zeros((number, species, self.bins + 2), np.int64)
        self.sums = np.zeros((number, species, POWERS))
        self._species, self._now, self._index = gas.species.astype(np.intp), np.zeros(len(gas)), 0
        self._samples: list[np.ndarray] = []

    def add(self, flights: Flights) -> None:
        """Add a batch of flights."""
        collisions = flights.kind == Kind.DISC
        disc, index = flights.disc[collisions], ((flights.end[collisions] - self._start) / self.time).astype(np.intp)
        ends = np.append(np.flatnonzero(np.diff(index)) + 1, len(index))
        first = 0
        for end in ends.tolist() if len(index) else ():
            while self._index < index[first]:
                self._close()
            self._now += np.bincount(disc[first:end], minlength=len(self._now))
            first = end

    def finish(self) -> None:
        """Close the last intervals and assemble the sample."""
        while self._index < self._times:
            self._close()
        columns = np.concatenate(self._samples, axis=1) if self._samples else np.empty((3, 0))
        self.sample, self.sample_index, self.sample_species = columns[0], columns[1].astype(int), columns[2].astype(int)

    def _close(self) -> None:
        """Count the discs by their number of collisions in the current interval, and begin the next interval."""
        now, v = self._now, self._index
        if v < self._times:
            group = v // self._together
            species, bins = self.counts.shape[1], self.bins + 2
            place = self._species * bins + np.minimum(now, self.bins).astype(np.intp) + 1
            self.counts[group] += np.bincount(place, minlength=species * bins).reshape(species, bins)
            for power in range(POWERS):
                self.sums[group, :, power] += np.bincount(self._species, now**power, species)
            chosen = slice(v % self.stride, None, self.stride)
            if len(sampled := now[chosen]):
                self._samples.append(np.array([sampled, np.full(len(sampled), group), self._species[chosen]]))
        self._now, self._index = np.zeros_like(now), v + 1
