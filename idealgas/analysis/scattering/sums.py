"""Sums over positions and velocities in segments of a window: correlations of waves, and displacements."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy import fft

from idealgas.analysis.core.ensemble import ensemble
from idealgas.analysis.core.equilibration import Window
from idealgas.analysis.core.stream import sample_trajectories
from idealgas.log import Log

WAVES = 4
"""Number of wave numbers, evenly spaced in their logarithm from that of the box to that of a diameter."""

STARTS = 32
"""Largest number of instants in a segment from which lags count."""

SEGMENTS = 32
"""Parts of the window; the spread over them gives the error bars."""

MOST_IN_MEMORY = 2**20
"""Number of positions that are in memory together."""


class Sums(NamedTuple):
    """Correlations (L,) in one segment, and mean Δr² and Δr⁴ after the lags of `powers_of_two` (P, 2)."""

    density: np.ndarray
    self_part: np.ndarray
    longitudinal: np.ndarray
    transverse: np.ndarray
    displacements: np.ndarray


def wave_numbers(log: Log) -> np.ndarray:
    """Numbers of waves in the longest side, up to one in a diameter."""
    most = max(max(log.box) / (2 * float(log.discs.radius[0])), 1.0)
    return np.unique(np.geomspace(1, int(most), WAVES).round())


def powers_of_two(lags: int) -> np.ndarray:
    """Powers of two below a number of lags, after which displacements are measured."""
    return 2 ** np.arange((lags - 1).bit_length())


def segments(log: Log, window: Window, k: float, step: float, lags: int) -> Iterator[Sums]:
    """Sums of each segment of a window, for waves of the wave number k along the longest sides."""
    room = window.duration - (lags - 1) * step
    starts = min(max(int(room / SEGMENTS / step), 1), STARTS)
    axes = [axis for axis in (0, 1) if log.box[axis] == max(log.box)]
    for begin in window.start + room / SEGMENTS * np.arange(SEGMENTS):
        times = np.minimum(begin + step * np.arange(starts + lags - 1), window.end)
        yield _segment(log, times, axes, k, lags)


def _segment(log: Log, times: np.ndarray, axes: list[int], k: float, lags: int) -> Sums:
    """Sums over all starts in evenly spaced times (G,)."""
    number, starts, drift = len(log.discs), len(times) - lags + 1, ensemble(log).centre_of_mass_velocity
    density, along, across = np.zeros((3, len(axes), len(times)), complex)
    self_part, powers = np.zeros(lags), powers_of_two(lags)
    displacements = np.zeros((len(powers), 2))
    for discs in np.array_split(np.arange(number), -(-number * len(times) // MOST_IN_MEMORY)):
        places, velocities = sample_trajectories(log, times, discs)
        places, velocities = places - drift * times[:, None, None], velocities - drift
        for a, axis in enumerate(axes):
            phases = np.exp(-1j * k * places[:, :, axis])
            density[a] += phases.sum(axis=1)
            along[a] += (velocities[:, :, axis] * phases).sum(axis=1)
            across[a] += (velocities[:, :, 1 - axis] * phases).sum(axis=1)
            self_part += correlation(phases, lags)
        for p, lag in enumerate(powers):
            square = ((places[lag : lag + starts] - places[:starts]) ** 2).sum(axis=2)
            displacements[p] += square.sum(), (square**2).sum()
    rho, j_along, j_across = (correlation(one.T, lags) / (len(axes) * number) for one in (density, along, across))
    return Sums(rho, self_part / (len(axes) * number), j_along, j_across, displacements / (starts * number))


def correlation(series: np.ndarray, lags: int) -> np.ndarray:
    """Sum over all series of the mean of Re x(t + lag) x*(t) (lags,) over the first n - lags + 1 times.

    series: (n, M), complex.
    """
    n = len(series)
    starts, size = n - lags + 1, fft.next_fast_len(n)
    whole, first = fft.fft(series, size, axis=0), fft.fft(series[:starts], size, axis=0)
    return fft.ifft((whole * first.conj()).sum(axis=1))[:lags].real / starts
