"""Intervals between events: free flights of discs and waiting times of the gas, as histograms and thinned samples."""

import numpy as np

from idealgas.jit import njit
from idealgas.log import Flights
from idealgas.state import Gas
from idealgas.tallies.flights import bin_of
from idealgas.tallies.stream import add_to, began_in


class Intervals:
    """Histogram of intervals by block and species, and a sample that contains every `stride`-th interval.

    An interval counts in the block in which it starts.

    Attributes:
        counts: (B, S, bins + 2), numbers of intervals below the bins, in each bin, and above the bins.
        sums: (B, S), sum of the intervals, length or time.
        sample: (n,), sampled intervals, length or time.
        sample_block: (n,), block in which each sampled interval starts.
        sample_species: (n,), species of the disc of each sampled interval.
    """

    cut = False

    def __init__(self, high: np.ndarray, bins: int, stride: int, most_samples: int) -> None:
        """Set the upper ends `high` (S,) of the histograms, length or time, the number of bins, and the sampling."""
        self.per_unit, self.bins, self.stride = bins / high, bins, stride
        self._left, self._seen = most_samples, 0
        self._samples: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []

    def _make_sums(self, edges: np.ndarray) -> None:
        self.edges = edges
        shape = (len(edges) - 1, len(self.per_unit))
        self.counts = np.zeros((*shape, self.bins + 2), np.int64)
        self.sums = np.zeros(shape)

    def finish(self) -> None:
        """Assemble the sample; intervals that have not ended by the end of the window are left out."""
        columns = zip(*self._samples, strict=True) if self._samples else np.empty((3, 1, 0))
        sample, block, species = (np.concatenate(list(values)) for values in columns)
        self.sample, self.sample_block, self.sample_species = sample, block.astype(int), species.astype(int)

    def _put(self, values: np.ndarray, block: np.ndarray, species: np.ndarray) -> None:
        """Add intervals (n,) in the order of their ends, with the blocks and species in which they start."""
        place = block * len(self.per_unit) + species
        add_to(self.counts, place * (self.bins + 2) + bin_of(values, 0.0, self.per_unit.take(species), self.bins))
        add_to(self.sums, place, values)
        chosen = np.arange(-self._seen % self.stride, len(values), self.stride)[: self._left]
        self._samples.append((values[chosen], block[chosen], species[chosen]))
        self._left -= len(chosen)
        self._seen += len(values)


class FreeFlights(Intervals):
    """Free path or free time of a disc between successive collisions with discs; wall hits do not end a free path."""

    def __init__(self, path: bool, high: np.ndarray, bins: int, stride: int, most_samples: int) -> None:
        """Set whether paths or times are measured; the other arguments are those of `Intervals`."""
        super().__init__(high, bins, stride, most_samples)
        self.path = path
        self.columns = ("disc", "block", "start", "end", "ends_in_collision", *(("path",) if path else ()))

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        self._make_sums(edges)
        self._species = gas.species.astype(np.intp)
        self._total, self._since = np.zeros(len(gas)), np.full(len(gas), -np.inf)

    def add(self, flights: Flights) -> None:
        """Add a batch of flights."""
        length = flights.path if self.path else flights.end - flights.start
        ends, start = flights.ends_in_collision, np.empty(len(length))
        _total_since_collision(
            flights.disc.astype(np.intp), flights.end.copy(), ends, length, start, self._total, self._since
        )
        ended = np.flatnonzero(ends & (start >= self.edges[0]))
        species = self._species.take(flights.disc[ended])
        self._put(length[ended], began_in(self.edges, start[ended], flights.block[ended]), species)


@njit
def _total_since_collision(
    disc: np.ndarray,
    end: np.ndarray,
    collides: np.ndarray,
    length: np.ndarray,
    start: np.ndarray,
    total: np.ndarray,
    since: np.ndarray,
) -> None:
    """Replace the lengths of flights by the total lengths since the last collision of the disc.

    This loop is compiled because a free path may consist of any number of flights between walls. With NumPy, the
    flights would have to be sorted by disc, or two sums from the start of the log subtracted, which loses digits.

    Args:
        disc: (n,), disc of each flight.
        end: (n,), time at which each flight ends.
        collides: (n,), whether each flight ends in a collision with a disc.
        length: (n,), length (or duration) of each flight; replaced.
        start: (n,), filled with the time of the last collision before each flight.
        total: (N,), length (or duration) since the last collision of each disc; updated.
        since: (N,), time of the last collision of each disc; updated.
    """
    for k in range(disc.shape[0]):
        i = disc[k]
        total[i] += length[k]
        length[k], start[k] = total[i], since[i]
        if collides[k]:
            total[i], since[i] = 0.0, end[k]


class WaitingTimes(Intervals):
    """Time between successive events of the gas, where a pair collision is one event."""

    columns = ("disc", "block", "end", "partner")

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        self._make_sums(edges)
        self._last = np.empty(0)

    def add(self, flights: Flights) -> None:
        """Add a batch of flights."""
        ended = np.flatnonzero((flights.partner < 0) | (flights.disc < flights.partner))
        times = np.append(self._last, flights.end[ended])
        block = flights.block[ended][len(ended) + 1 - len(times) :]
        self._put(np.diff(times), began_in(self.edges, times[:-1], block), np.zeros(len(block), np.intp))
        self._last = times[-1:]
