"""Correlations of waves, and displacements of discs, in the segments of a window."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy import fft

from idealgas.log import Log
from idealgas.tallies.equilibration import Window
from idealgas.tallies.stream import trajectories

WAVES = 4
"""Number of wave numbers, evenly spaced on a logarithmic scale from 2π/L to one wave per diameter."""

STARTS = 64
"""Number of initial instants in a segment; it is larger if the gaps between segments would otherwise be short."""

SEGMENTS = 32
"""Number of segments of the window; their scatter gives the standard errors."""

MOST_PLACES = 2**20
"""Largest number of positions in memory, over all instants; in a large gas only some discs give the self part."""

APART = 16
"""Lag of the displacements whose distribution is measured, in steps."""

BINS, FARTHEST = 30, 3.0
"""Number of bins of distances, and their upper end in theoretical root-mean-square displacements."""


class Sums(NamedTuple):
    """Correlations (L,) and displacements in one segment.

    Attributes:
        density: correlation of Σ exp(-ikx), over N (no unit).
        self_part: correlation of exp(-ikx) of a disc (no unit).
        longitudinal: correlation of the current along k, over N, (length/time)².
        transverse: correlation of the current perpendicular to k, over N, (length/time)².
        moments: (P, 2), mean Δr² and Δr⁴ after the lags of `powers_of_two`, length² and length⁴.
        distances: (BINS,), fraction of the discs whose displacement in APART steps lies in each bin.
    """

    density: np.ndarray
    self_part: np.ndarray
    longitudinal: np.ndarray
    transverse: np.ndarray
    moments: np.ndarray
    distances: np.ndarray


class Series(NamedTuple):
    """A wave at G instants: its amplitudes, and the positions of M sampled discs.

    Attributes:
        at: (G,), times of the instants, in steps from the start of the window.
        starts: number of initial instants in each segment.
        begins: (SEGMENTS,), indices of the first instants of the segments.
        axes: the A axes along which the wave runs.
        waves: (3, A, G), Σ exp(-ikx), the longitudinal current and the transverse current.
        places: (2, G, M), x and y, not wrapped into the box, length.
    """

    at: np.ndarray
    starts: int
    begins: np.ndarray
    axes: list[int]
    waves: np.ndarray
    places: np.ndarray


def wave_numbers(log: Log) -> np.ndarray:
    """Return wave numbers in units of 2π/L, where L is the longer side, up to about one wave per diameter."""
    most = max(max(log.box) / (2 * float(log.discs.radius[0])), 1.0)
    return np.unique(np.geomspace(1, int(most), WAVES).round())


def powers_of_two(lags: int) -> np.ndarray:
    """Return the powers of two below a number of lags; displacements are measured after these lags."""
    return 2 ** np.arange((lags - 1).bit_length())


def read(log: Log, window: Window, k: float, step: float, lags: int) -> Series:
    """Read the amplitudes of a wave of wave number k along the longest sides; each instant is read once.

    In a short window, lags start at every instant of a segment. In a long window, each segment has STARTS initial
    instants, and there are gaps between the segments.
    """
    apart = int((window.duration / step - lags + 2) / SEGMENTS)
    starts = apart if apart <= STARTS + lags else STARTS
    begins = apart * np.arange(SEGMENTS)
    at = np.unique(begins[:, None] + np.arange(starts + lags - 1))
    axes = [axis for axis in (0, 1) if log.box[axis] == max(log.box)]
    chosen = np.arange(len(log.discs))[:: -(-len(log.discs) * len(at) // MOST_PLACES)]
    waves, places = np.empty((3, len(axes), len(at)), complex), np.empty((2, len(at), len(chosen)))
    for part in np.split(np.arange(len(at)), np.flatnonzero(np.diff(at) > 1) + 1):
        for instants, place, velocity in trajectories(log, np.minimum(window.start + step * at[part], window.end)):
            now = part[instants]
            for a, axis in enumerate(axes):
                phase, along, across = k * place[:, :, axis], velocity[:, :, axis], velocity[:, :, 1 - axis]
                cos, sin = np.cos(phase), np.sin(phase)
                waves[0, a, now] = cos.sum(axis=1) - 1j * sin.sum(axis=1)
                waves[1, a, now] = (along * cos).sum(axis=1) - 1j * (along * sin).sum(axis=1)
                waves[2, a, now] = (across * cos).sum(axis=1) - 1j * (across * sin).sum(axis=1)
            places[:, now] = np.moveaxis(place[:, chosen], 2, 0)
    return Series(at, starts, at.searchsorted(begins), axes, waves, places)


def segments(log: Log, k: float, lags: int, series: Series, edges: np.ndarray) -> Iterator[Sums]:
    """Yield the correlations and displacements in each segment; edges: edges of the bins of distances, length."""
    starts, number = series.starts, len(series.axes)
    phases = [np.exp(-1j * k * series.places[axis]) for axis in series.axes]
    for first in series.begins:
        instants = slice(first, first + starts + lags - 1)
        places = series.places[:, instants]
        waves = (correlation(wave.T, lags) / (number * len(log.discs)) for wave in series.waves[:, :, instants])
        density, longitudinal, transverse = waves
        self_part = np.sum([correlation(phase[instants], lags) for phase in phases], axis=0) / (
            number * places.shape[2]
        )
        squares = [squares_after(places, lag, starts) for lag in powers_of_two(lags)]
        moments = np.array([(square.mean(), (square * square).mean()) for square in squares])
        fractions = np.histogram(squares[APART.bit_length() - 1], edges**2)[0] / squares[0].size
        yield Sums(density, self_part, longitudinal, transverse, moments, fractions)


def squares_after(places: np.ndarray, lag: int, starts: int) -> np.ndarray:
    """Return the squared displacements (starts, M) after `lag` instants, given positions (2, n, M)."""
    x, y = places[:, lag : lag + starts] - places[:, :starts]
    return np.asarray(x * x + y * y)


def correlation(series: np.ndarray, lags: int) -> np.ndarray:
    """Return Re x(t + lag) x*(t), averaged over the first n - lags + 1 times and summed over the M series, (lags,).

    series: (n, M), complex.
    """
    n = len(series)
    starts, size = n - lags + 1, fft.next_fast_len(n)
    whole, first = fft.fft(series, size, axis=0), fft.fft(series[:starts], size, axis=0)
    return fft.ifft((whole * first.conj()).sum(axis=1))[:lags].real / starts
