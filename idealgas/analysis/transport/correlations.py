"""Time correlations of velocities and positions, calculated with Fourier transforms."""

import numpy as np
from scipy import fft


def correlation(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return ⟨a(t)·b(t + lag)⟩ (segments, L) of two series, averaged over discs and over times t in each segment.

    The series `first` and `second` have shape (segments, L, discs, 2) and equal time steps.
    """
    length = first.shape[1]
    padded = fft.next_fast_len(2 * length - 1, real=True)
    transform = np.fft.rfft(first, padded, axis=1)
    transform_of_second = transform if second is first else np.fft.rfft(second, padded, axis=1)
    power = (transform.conj() * transform_of_second).sum(axis=3).mean(axis=2)
    return np.fft.irfft(power, padded, axis=1)[:, :length] / np.arange(length, 0, -1)


def velocity_integral(velocities: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the integral of ⟨v(t)·v(t + lag)⟩ from 0 to each lag, (segments, L), length²/time.

    The integral is calculated as the sum of ⟨v(t)·[r(t + lag + step) - r(t + lag)]⟩, which is exact for steps of any
    length. The arrays `velocities` and `places` have shape (segments, L, discs, 2) and equal time steps.
    """
    steps = correlation(velocities[:, :-1], np.diff(places, axis=1))
    return np.concatenate((np.zeros_like(steps[:, :1]), steps.cumsum(axis=1)), axis=1)


def mean_square_displacement(places: np.ndarray) -> np.ndarray:
    """Return the mean square displacement ⟨|r(t + lag) - r(t)|²⟩ over discs and times t, (segments, L), length².

    It is calculated from Σ r² and the autocorrelation of the positions: Calandrini et al., Collection SFN 12, 201
    (2011). The array `places` has shape (segments, L, discs, 2) and equal time steps.
    """
    length = places.shape[1]
    places = places - places[:, :1]  # smaller numbers have smaller rounding errors
    square = (places**2).sum(axis=3).mean(axis=2)
    both = np.concatenate((np.zeros_like(square[:, :1]), square.cumsum(axis=1)), axis=1)
    steps = np.arange(length)
    first, last = both[:, length - steps], both[:, -1:] - both[:, steps]
    return (first + last) / (length - steps) - 2 * correlation(places, places)
