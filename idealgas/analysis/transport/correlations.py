"""Correlations in time of velocities and of positions, by Fourier transforms."""

import numpy as np
from scipy import fft


def autocorrelation(velocities: np.ndarray) -> np.ndarray:
    """Velocity autocorrelation ⟨v(t)·v(t + lag)⟩ (segments, L), averaged over discs and the times t of each segment.

    velocities: (segments, L, discs, 2), at equal steps.
    """
    length = velocities.shape[1]
    padded = fft.next_fast_len(2 * length - 1, real=True)
    spectrum = np.fft.rfft(velocities, padded, axis=1)
    power = (spectrum.real**2 + spectrum.imag**2).sum(axis=3).mean(axis=2)
    raw = np.fft.irfft(power, padded, axis=1)[:, :length]
    return raw / np.arange(length, 0, -1)


def mean_square_displacement(places: np.ndarray) -> np.ndarray:
    """Mean square displacement ⟨|r(t + lag) - r(t)|²⟩ (segments, L) over discs and times t of a segment, length².

    places: (segments, L, discs, 2), at equal steps. It is computed from Σ r² and the autocorrelation of the
    positions: Calandrini et al., Collection SFN 12, 201 (2011).
    """
    length = places.shape[1]
    places = places - places[:, :1]  # smaller numbers keep more digits
    square = (places**2).sum(axis=3).mean(axis=2)
    both = np.concatenate((np.zeros_like(square[:, :1]), square.cumsum(axis=1)), axis=1)
    steps = np.arange(length)
    first, last = both[:, length - steps], both[:, -1:] - both[:, steps]
    return (first + last) / (length - steps) - 2 * autocorrelation(places)
