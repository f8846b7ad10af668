"""Displacements of discs: the self part of the van Hove function, and the non-Gaussian parameter."""

import math
from dataclasses import dataclass

import numpy as np

from idealgas.analysis.scattering.sums import APART, Sums, powers_of_two


@dataclass(frozen=True)
class Curve:
    """Values of a function of time, frequency or distance, and their standard errors in the same unit."""

    value: np.ndarray
    error: np.ndarray


@dataclass(frozen=True)
class VanHove:
    """Self part of the van Hove function at one time: the probability density of the displacements of discs.

    Attributes:
        time: time.
        distance: (BINS,), distances, length.
        density: (BINS,), G_s(r, t), averaged over each bin, 1/length².
        gaussian: (BINS,), normal distribution with the same mean square displacement, 1/length².
        square: mean square displacement ⟨Δr²⟩, length².
    """

    time: float
    distance: np.ndarray
    density: Curve
    gaussian: np.ndarray
    square: float


def curve_of(parts: np.ndarray) -> Curve:
    """Return the mean over the segments (S, L) and its standard error."""
    return Curve(parts.mean(axis=0), parts.std(axis=0, ddof=1) / math.sqrt(len(parts)))


def van_hove(time: float, edges: np.ndarray, sums: list[Sums]) -> VanHove:
    """Return the self part of the van Hove function after a time, from the displacements in all segments.

    edges: (BINS + 1,), edges of the bins of distances, length.
    """
    area = math.pi * np.diff(edges**2)
    square = float(np.mean([segment.moments[APART.bit_length() - 1, 0] for segment in sums]))
    normal = -np.diff(np.exp(-(edges**2) / square))
    density = curve_of(np.array([segment.distances for segment in sums]) / area)
    return VanHove(time, (edges[1:] + edges[:-1]) / 2, density, normal / area, square)


def non_gaussian(parts: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, Curve]:
    """Return times and the non-Gaussian parameter, given times (L,) and moments (S, P, 2) for each wave number.

    The measurements of short waves cover short times, and those of long waves cover long times.
    """
    points: list[tuple[float, float, float]] = []
    for time, moments in reversed(parts):
        for lag, (square, fourth) in zip(powers_of_two(len(time)), np.moveaxis(moments, 0, 2), strict=True):
            if not points or time[lag] > points[-1][0] * 1.01:
                second = square.mean()
                change = (fourth - fourth.mean()) - 2 * fourth.mean() / second * (square - second)
                error = float(change.std(ddof=1)) / math.sqrt(len(change)) / (2 * second**2)
                points.append((float(time[lag]), float(fourth.mean() / (2 * second**2) - 1), float(error)))
    times, values, errors = np.array(points).T
    return times, Curve(values, errors)
