"""Intervals between events: free flights of discs and waiting times of the gas, as histograms and thinned samples."""

from typing import Any

import numpy as np

from idealgas.analysis.core.ballistic import length_of_flight
from idealgas.analysis.core.flights import bin_of
from idealgas.analysis.core.stream import block_at, block_back
from idealgas.jit import inline, njit
from idealgas.state import Gas


class _Intervals:
    """Histogram of intervals by the block and the species in which they start, and a sample of every `stride`-th one.

    counts: (B, S, bins + 2), numbers of intervals below, in and above the bins. sums: (B, S), sum of the intervals, in
    lengths or times. sample, sample_block, sample_species: sampled intervals, and the block and species of their start.
    """

    def __init__(self, high: np.ndarray, bins: int, stride: int, most_samples: int) -> None:
        """Take the upper end of the histogram of each species, high (S,), in lengths or times."""
        self.per_unit, self.bins, self.stride = bins / high, bins, stride
        self._sample = np.zeros(most_samples)
        self._origin = np.zeros((most_samples, 2), np.int64)
        self._seen = np.zeros(1, np.int64)

    def _make_sums(self, edges: np.ndarray) -> None:
        self.edges = edges
        shape = (len(edges) - 1, len(self.per_unit))
        self.counts = np.zeros((*shape, self.bins + 2), np.int64)
        self.sums = np.zeros(shape)
        self._block = 0

    def finish(self) -> None:
        """Do nothing: intervals that have not ended by the end of the window are left out."""
        taken = min(len(self._sample), -(-int(self._seen[0]) // self.stride))
        self.sample = self._sample[:taken]
        self.sample_block, self.sample_species = self._origin[:taken].T


@inline
def _put(value, block, s, per_unit, counts, sums, stride, seen, sample, origin):
    counts[block, s, bin_of(value, 0.0, per_unit[s], counts.shape[2] - 2)] += 1
    sums[block, s] += value
    if seen[0] % stride == 0 and seen[0] // stride < sample.shape[0]:
        sample[seen[0] // stride] = value
        origin[seen[0] // stride, 0] = block
        origin[seen[0] // stride, 1] = s
    seen[0] += 1


class FreeFlights(_Intervals):
    """Free path or free time of a disc between successive collisions with discs; wall hits do not end a free path."""

    columns = ("time", "disc", "partner", "velocity")

    def __init__(
        self,
        path: bool,
        high: np.ndarray,
        bins: int,
        stride: int,
        most_samples: int,
        gravity: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Take whether paths are measured or times, and the acceleration `gravity` in length/time²."""
        super().__init__(high, bins, stride, most_samples)
        self.path, self.gravity = path, gravity

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the state of the discs at time edges[0]; edges: (B + 1,), times between the blocks."""
        self._make_sums(edges)
        self._species = gas.species
        # time of the last event, velocity then, path (or time) since the last collision, time of that collision
        self._tracks = np.zeros((len(gas), 5))
        self._tracks[:, 4] = -np.inf

    def add(self, rows: Any) -> None:
        """Add the next event rows of the log."""
        self._block = _add_free_flights(
            rows.time, rows.disc, rows.partner, rows.velocity, self.path, self.gravity, self._species, self._tracks,
            self.edges, self._block, self.per_unit, self.counts, self.sums, self.stride, self._seen, self._sample,
            self._origin,
        )  # fmt: skip


@njit
def _add_free_flights(
    time, disc, partner, velocity, path, gravity, species, tracks, edges, block,
    per_unit, counts, sums, stride, seen, sample, origin,
):  # fmt: skip
    for row in range(time.shape[0]):
        i = np.uintp(disc[row])
        now = time[row]
        block = block_at(edges, block, now)
        track = tracks[i]
        since = now - track[0]
        track[3] += length_of_flight(track[1], track[2], gravity, since) if path else since
        if partner[row] >= 0:
            if track[4] >= edges[0]:
                began = block_back(edges, block, track[4])
                _put(track[3], began, species[i], per_unit, counts, sums, stride, seen, sample, origin)
            track[3] = 0.0
            track[4] = now
        track[0] = now
        track[1] = velocity[row, 0]
        track[2] = velocity[row, 1]
    return block


class Waits(_Intervals):
    """Time between successive events of the gas, a pair collision being one event."""

    columns = ("time", "disc", "partner")

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the state of the discs at time edges[0]; edges: (B + 1,), times between the blocks."""
        self._make_sums(edges)
        self._last = -np.inf

    def add(self, rows: Any) -> None:
        """Add the next event rows of the log."""
        self._block, self._last = _add_waits(
            rows.time, rows.disc, rows.partner, self._last, self.edges,
            self._block, self.per_unit, self.counts, self.sums, self.stride, self._seen, self._sample, self._origin,
        )  # fmt: skip


@njit
def _add_waits(time, disc, partner, last, edges, block, per_unit, counts, sums, stride, seen, sample, origin):
    for row in range(time.shape[0]):
        if partner[row] >= 0 and disc[row] > partner[row]:
            continue
        now = time[row]
        began = block
        block = block_at(edges, block, now)
        if last >= edges[0]:
            began = block_back(edges, block, last)
            _put(now - last, began, 0, per_unit, counts, sums, stride, seen, sample, origin)
        last = now
    return block, last
