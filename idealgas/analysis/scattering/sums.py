"""Sums over positions and velocities in segments of a window: correlations of waves, and displacements."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy import fft

from idealgas.analysis.core.equilibration import Window
from idealgas.analysis.core.stream import trajectories
from idealgas.log import Log

WAVES = 4
"""Number of wave numbers, evenly spaced in their logarithm from that of the box to that of a diameter."""

STARTS = 64
"""Number of instants in a segment from which lags count, unless segments with all of them hold few more instants."""

SEGMENTS = 32
"""Parts of the window; the spread over them gives the error bars."""

MOST_PLACES = 2**20
"""Number of positions that are kept at all instants; of more discs a part gives the self part and displacements."""

APART = 16
"""Lag after which distances are counted, in steps."""

BINS, FARTHEST = 30, 3.0
"""Number of bins of distances, and their end in root-mean-square displacements by theory."""


class Sums(NamedTuple):
    """Correlations (L,) in one segment, and displacements.

    moments: (P, 2), mean Δr² and Δr⁴ after the lags of `powers_of_two`. distances: (BINS,), shares of the discs that
    are at distances in bins from their place APART steps before.
    """

    density: np.ndarray
    self_part: np.ndarray
    longitudinal: np.ndarray
    transverse: np.ndarray
    moments: np.ndarray
    distances: np.ndarray


class Series(NamedTuple):
    """A wave at G instants, in units of the time between two: amplitudes, and places of some discs.

    at: (G,), whole numbers from the start of the window on. starts: number of starts of lags in each segment. begins:
    (SEGMENTS,), indices of their first instants. axes: A axes along which the wave runs. waves: (3, A, G), Σ exp(-ikx)
    and the currents along and across k. places: (2, G, M), x and y, unwrapped, length.
    """

    at: np.ndarray
    starts: int
    begins: np.ndarray
    axes: list[int]
    waves: np.ndarray
    places: np.ndarray


def wave_numbers(log: Log) -> np.ndarray:
    """Numbers of waves in the longest side, up to one in a diameter."""
    most = max(max(log.box) / (2 * float(log.discs.radius[0])), 1.0)
    return np.unique(np.geomspace(1, int(most), WAVES).round())


def powers_of_two(lags: int) -> np.ndarray:
    """Powers of two below a number of lags, after which displacements are measured."""
    return 2 ** np.arange((lags - 1).bit_length())


def read(log: Log, window: Window, k: float, step: float, lags: int) -> Series:
    """Read a wave of the wave number k along the longest sides, each instant once.

    Segments have all instants of a short window as starts, and STARTS each, with gaps between them, of a long one.
    """
    apart = int((window.duration / step - lags + 2) / SEGMENTS)
    starts = apart if apart <= STARTS + lags else STARTS
    begins = apart * np.arange(SEGMENTS)
    at = np.unique(begins[:, None] + np.arange(starts + lags - 1))
    axes = [axis for axis in (0, 1) if log.box[axis] == max(log.box)]
    chosen = np.arange(len(log.discs))[:: -(-len(log.discs) * len(at) // MOST_PLACES)]
    waves, places = np.empty((3, len(axes), len(at)), complex), np.empty((2, len(at), len(chosen)))
    for part in np.split(np.arange(len(at)), np.flatnonzero(np.diff(at) > 1) + 1):
        for some, place, velocity in trajectories(log, np.minimum(window.start + step * at[part], window.end)):
            now = part[some]
            for a, axis in enumerate(axes):
                phase, along, across = k * place[:, :, axis], velocity[:, :, axis], velocity[:, :, 1 - axis]
                cos, sin = np.cos(phase), np.sin(phase)
                waves[0, a, now] = cos.sum(axis=1) - 1j * sin.sum(axis=1)
                waves[1, a, now] = (along * cos).sum(axis=1) - 1j * (along * sin).sum(axis=1)
                waves[2, a, now] = (across * cos).sum(axis=1) - 1j * (across * sin).sum(axis=1)
            places[:, now] = np.moveaxis(place[:, chosen], 2, 0)
    return Series(at, starts, at.searchsorted(begins), axes, waves, places)


def segments(log: Log, k: float, lags: int, series: Series, edges: np.ndarray) -> Iterator[Sums]:
    """Sums of each segment of a wave; edges: of the bins of distances, length."""
    starts, number = series.starts, len(series.axes)
    phases = [np.exp(-1j * k * series.places[axis]) for axis in series.axes]
    for first in series.begins:
        some = slice(first, first + starts + lags - 1)
        places = series.places[:, some]
        waves = (correlation(one.T, lags) / (number * len(log.discs)) for one in series.waves[:, :, some])
        density, longitudinal, transverse = waves
        own = np.sum([correlation(one[some], lags) for one in phases], axis=0) / (number * places.shape[2])
        squares = [squares_after(places, lag, starts) for lag in powers_of_two(lags)]
        moments = np.array([(square.mean(), (square * square).mean()) for square in squares])
        found = np.histogram(squares[APART.bit_length() - 1], edges**2)[0] / squares[0].size
        yield Sums(density, own, longitudinal, transverse, moments, found)


def squares_after(places: np.ndarray, lag: int, starts: int) -> np.ndarray:
    """Squares (starts, M) of displacements after a number of instants, from places (2, n, M)."""
    x, y = places[:, lag : lag + starts] - places[:, :starts]
    return np.asarray(x * x + y * y)


def correlation(series: np.ndarray, lags: int) -> np.ndarray:
    """Sum over all series of the mean of Re x(t + lag) x*(t) (lags,) over the first n - lags + 1 times.

    series: (n, M), complex.
    """
    n = len(series)
    starts, size = n - lags + 1, fft.next_fast_len(n)
    whole, first = fft.fft(series, size, axis=0), fft.fft(series[:starts], size, axis=0)
    return fft.ifft((whole * first.conj()).sum(axis=1))[:lags].real / starts
