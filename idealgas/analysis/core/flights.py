"""Time averages of velocities: moments and histograms, weighted with the duration of each flight."""

import math
from typing import Any

import numpy as np

from idealgas.analysis.core.ballistic import (
    changes_in_fall,
    integral_over_fall,
    length_of_fall,
    time_at_value,
    turning_time,
    value_in_fall,
    velocity_quantity,
)
from idealgas.analysis.core.stream import block_at, block_back
from idealgas.events import BATH
from idealgas.jit import inline, njit
from idealgas.physics.motion import velocity_after
from idealgas.state import Gas

VELOCITY_QUANTITIES = ("speed", "vx", "vy", "energy")

T, VX, VY = range(3)  # columns of a track: time of the disc's last event, velocity after it


def make_tracks(gas: Gas, start: float) -> np.ndarray:
    """Tracks (N, 3) of all discs: time `start` and the components of the velocity then."""
    return np.column_stack((np.full(len(gas), start), gas.velocity))


class Moments:
    """Time integrals of velocity moments, summed over the discs of each species, and event counts in each block.

    flights: (B, S, 4), integrals of |v|, m vx², m vy² and (m v²)² over time for B blocks and S species.
    events: (B, 2), numbers of pair collisions and of wall hits.
    """

    columns = ("time", "disc", "partner", "velocity")

    def __init__(self, gravity: tuple[float, float] = (0.0, 0.0)) -> None:
        """Take the acceleration `gravity` in length/time²; with it flights are parabolas."""
        self.gravity = gravity

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the state of the discs at time edges[0]; edges: (B + 1,), times between the blocks."""
        self.edges = edges
        self.flights = np.zeros((len(edges) - 1, len(gas.species_names), 4))
        self.events = np.zeros((len(edges) - 1, 2), np.int64)
        self._species, self._mass = gas.species, gas.mass
        self._tracks = make_tracks(gas, edges[0])
        self._block = 0

    def add(self, rows: Any) -> None:
        """Add the next event rows of the log."""
        self._block = _add_moments(
            rows.time, rows.disc, rows.partner, rows.velocity, self.gravity,
            self._species, self._mass, self._tracks, self.edges, self._block, self.flights, self.events,
        )  # fmt: skip

    def finish(self) -> None:
        """Add the last part of the flight of every disc, up to time edges[-1]."""
        _finish_moments(self.gravity, self._species, self._mass, self._tracks, self.edges, self.flights)


@inline
def _spend_moments(track, gravity, species, mass, until, edges, block, flights):
    falls = gravity[0] != 0.0 or gravity[1] != 0.0
    since = track[T]
    k = block_back(edges, block, since)
    while True:
        stop = until if k == block else edges[k + 1]
        weight = stop - since
        vx = velocity_after(track[VX], gravity[0], since - track[T])
        vy = velocity_after(track[VY], gravity[1], since - track[T])
        sums = flights[k, species]
        if falls:
            _add_fall(sums, mass, vx, vy, gravity[0], gravity[1], weight)
        else:
            square = vx * vx + vy * vy
            energy = mass * square  # twice the kinetic energy
            sums[0] += weight * math.sqrt(square)
            sums[1] += mass * weight * vx * vx
            sums[2] += mass * weight * vy * vy
            sums[3] += weight * energy * energy
        if k == block:
            break
        since = stop
        k += 1


@inline
def _add_fall(sums, mass, vx, vy, gx, gy, t):
    """Add the time integrals over a parabolic flight of duration t that starts at velocity (vx, vy)."""
    a, b, c = gx * gx + gy * gy, vx * gx + vy * gy, vx * vx + vy * vy  # v² = a s² + 2 b s + c
    sums[0] += length_of_fall(vx, vy, (gx, gy), t)
    sums[1] += mass * t * (vx * vx + t * gx * (vx + t * gx / 3.0))
    sums[2] += mass * t * (vy * vy + t * gy * (vy + t * gy / 3.0))
    power = c * c + t * (2.0 * b * c + t * ((4.0 * b * b + 2.0 * a * c) / 3.0 + t * (a * b + t * a * a / 5.0)))
    sums[3] += mass * mass * t * power


@njit
def _add_moments(time, disc, partner, velocity, gravity, species, mass, tracks, edges, block, flights, events):
    for row in range(time.shape[0]):
        i = np.uintp(disc[row])
        now = time[row]
        block = block_at(edges, block, now)
        track = tracks[i]
        _spend_moments(track, gravity, species[i], mass[i], now, edges, block, flights)
        track[T] = now
        track[VX] = velocity[row, 0]
        track[VY] = velocity[row, 1]
        if partner[row] < 0:
            events[block, 1] += partner[row] != BATH
        elif disc[row] > partner[row]:
            events[block, 0] += 1
    return block


@njit
def _finish_moments(gravity, species, mass, tracks, edges, flights):
    for i in range(tracks.shape[0]):
        _spend_moments(tracks[i], gravity, species[i], mass[i], edges[-1], edges, edges.shape[0] - 2, flights)


class VelocityHistogram:
    """Histogram of one velocity quantity, weighted with time, and its values for some discs at the inner block edges.

    counts: (B, S, bins + 2), time that discs spent below, in and above the bins. sums: (B, S), integral of the quantity
    over time. snapshots: (B - 1, M), values of the M `sampled` discs at the edges between blocks.
    """

    columns = ("time", "disc", "velocity")

    def __init__(
        self,
        quantity: str,
        low: np.ndarray,
        high: np.ndarray,
        bins: int,
        sampled: np.ndarray,
        gravity: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Take the range of the bins of each species: low and high of shape (S,), in the unit of the quantity.

        gravity: acceleration between events, length/time².
        """
        self.gravity = gravity
        self.quantity = VELOCITY_QUANTITIES.index(quantity)
        self.low, self.per_unit, self.bins = low, bins / (high - low), bins
        self.sampled = sampled

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the state of the discs at time edges[0]; edges: (B + 1,), times between the blocks."""
        self.edges = edges
        self.counts = np.zeros((len(edges) - 1, len(gas.species_names), self.bins + 2))
        self.sums = np.zeros((len(edges) - 1, len(gas.species_names)))
        self.snapshots = np.zeros((len(edges) - 1, len(self.sampled)))
        self._slot = np.full(len(gas), -1)
        self._slot[self.sampled] = np.arange(len(self.sampled))
        self._species, self._mass = gas.species, gas.mass
        self._tracks = make_tracks(gas, edges[0])
        self._block = 0

    def add(self, rows: Any) -> None:
        """Add the next event rows of the log."""
        self._block = _add_histogram(
            rows.time, rows.disc, rows.velocity, self.quantity, self.gravity, self._species, self._mass, self._slot,
            self._tracks, self.edges, self._block, self.low, self.per_unit, self.counts, self.sums, self.snapshots,
        )  # fmt: skip

    def finish(self) -> None:
        """Add the last part of the flight of every disc, up to time edges[-1]."""
        _finish_histogram(
            self.quantity, self.gravity, self._species, self._mass, self._slot,
            self._tracks, self.edges, self.low, self.per_unit, self.counts, self.sums, self.snapshots,
        )  # fmt: skip
        self.snapshots = self.snapshots[:-1]


@inline
def bin_of(value, low, per_unit, bins):
    """Index of the bin of a value: 0 below the range, 1 to `bins` inside, bins + 1 above."""
    place = (value - low) * per_unit
    inside = np.int64(min(max(place, -1.0), bins + 0.0))
    return 0 if place < 0 else inside + 1


@inline
def _spend_histogram(
    quantity, gravity, mass, slot, track, s, until, edges, block, low, per_unit, counts, sums, snapshots
):
    vx, vy = track[VX], track[VY]
    changes = changes_in_fall(quantity, gravity)
    value = velocity_quantity(quantity, mass, vx, vy)
    b = bin_of(value, low[s], per_unit[s], counts.shape[2] - 2)
    since = track[T]
    k = block_back(edges, block, since)
    while True:
        stop = until if k == block else edges[k + 1]
        if changes:
            start, weight = since - track[T], stop - since
            fall_x = velocity_after(vx, gravity[0], start)
            fall_y = velocity_after(vy, gravity[1], start)
            _spend_fall(quantity, mass, fall_x, fall_y, gravity, weight, low[s], per_unit[s], counts[k, s])
            sums[k, s] += integral_over_fall(quantity, mass, fall_x, fall_y, gravity, weight)
            value = value_in_fall(quantity, mass, fall_x, fall_y, gravity, weight)
        else:
            counts[k, s, b] += stop - since
            sums[k, s] += value * (stop - since)
        if k == block:
            break
        if slot >= 0:
            snapshots[k, slot] = value
        since = stop
        k += 1


@inline
def _spend_fall(quantity, mass, vx, vy, gravity, duration, low, per_unit, counts):
    """Add the times to counts (bins + 2,) that a quantity spends in each bin during a fall."""
    bins = counts.shape[0] - 2
    turn = turning_time(quantity, vx, vy, gravity)
    b = bin_of(velocity_quantity(quantity, mass, vx, vy), low, per_unit, bins)
    since = 0.0
    while since < duration:  # twice at most: before the least value and after it
        rises = since >= turn
        until = duration if rises else min(turn, duration)
        last = bin_of(value_in_fall(quantity, mass, vx, vy, gravity, until), low, per_unit, bins)
        step = 1 if last > b else -1
        while b != last:
            edge = low + (b if step > 0 else b - 1) / per_unit
            met = min(max(time_at_value(quantity, mass, edge, rises, vx, vy, gravity), since), until)
            counts[b] += met - since
            since = met
            b += step
        counts[b] += until - since
        since = until


@njit
def _add_histogram(
    time, disc, velocity, quantity, gravity, species, mass, slot,
    tracks, edges, block, low, per_unit, counts, sums, snapshots,
):  # fmt: skip
    for row in range(time.shape[0]):
        i = np.uintp(disc[row])
        now = time[row]
        block = block_at(edges, block, now)
        track = tracks[i]
        _spend_histogram(
            quantity, gravity, mass[i], slot[i], track, species[i], now,
            edges, block, low, per_unit, counts, sums, snapshots,
        )  # fmt: skip
        track[T] = now
        track[VX] = velocity[row, 0]
        track[VY] = velocity[row, 1]
    return block


@njit
def _finish_histogram(quantity, gravity, species, mass, slot, tracks, edges, low, per_unit, counts, sums, snapshots):
    last = edges.shape[0] - 2
    for i in range(tracks.shape[0]):
        _spend_histogram(
            quantity,
            gravity,
            mass[i],
            slot[i],
            tracks[i],
            species[i],
            edges[-1],
            edges,
            last,
            low,
            per_unit,
            counts,
            sums,
            snapshots,
        )
