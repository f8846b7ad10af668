"""Transport coefficients from the growth of integrated currents: Einstein's and Helfand's route.

The integral G of a fluctuating current over a time t spreads like a random walk, ⟨G²⟩ = 2 K t, once the current has
lost its memory. The coefficient is half the slope of ⟨G²⟩. At earlier times it is a function of t, equal to the
Green–Kubo integral of the autocorrelation of the current up to t.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.statistics.autoregression import unit_of

MOST_PARTS = 64
"""Largest number of parts of a run whose scatter gives the error at every lag."""


class Lags(NamedTuple):
    """Lags of a growth: steps of equal width, and the plateau from a first to the last step.

    Attributes:
        width: width of a step, which is that of a block, time.
        first: number of steps up to the beginning of the plateau, 0 < first < last.
        last: number of all steps.
    """

    width: float
    first: int
    last: int

    @property
    def plateau(self) -> tuple[float, float]:
        """First and last time of the plateau."""
        return self.first * self.width, self.last * self.width

    @property
    def times(self) -> np.ndarray:
        """Middles of the steps, (last,), time."""
        return (np.arange(self.last) + 0.5) * self.width


class Growth(NamedTuple):
    """Half the slope of ⟨G²⟩ of one current, or of several equivalent ones.

    Attributes:
        series: (routes, n), its mean over the plateau from each of n starting times, by route.
        running: (last,), its value at the `Lags.times`.
        error: (last,), standard error of this value.
    """

    series: np.ndarray
    running: np.ndarray
    error: np.ndarray


def lags_of(width: float, longest: float, share: float) -> Lags:
    """Return lags up to about the longest one, time, with a plateau from a fraction of it on, for blocks of a width."""
    last = max(round(longest / width), 2)
    return Lags(width, min(max(round(share * last), 1), last - 1), last)


def growth(flow: np.ndarray, lags: Lags) -> Growth:
    """Return the growth of currents from their integrals (routes, B) over successive blocks.

    The mean current of the run is subtracted. ⟨G²⟩ thereby loses a fraction t/τ in a run of length τ, which is
    corrected.
    """
    routes, blocks = flow.shape
    total = np.zeros((routes, blocks + 1))
    np.cumsum(flow - flow.mean(axis=1, keepdims=True), axis=1, out=total[:, 1:])
    starts = blocks + 1 - lags.last
    parts = min(MOST_PARTS, max(starts // lags.last, 2))
    used = starts - starts % parts
    squares = np.zeros((lags.last + 1, parts))
    series = np.zeros((routes, starts))
    for k in range(1, lags.last + 1):
        square = (total[:, k : k + starts] - total[:, :starts]) ** 2
        squares[k] = square[:, :used].mean(axis=0).reshape(parts, -1).mean(axis=1)
        if k in (lags.first, lags.last):
            series += square if k == lags.last else -square
    walked = 2 * lags.width * (np.arange(lags.last + 1) - np.arange(lags.last + 1) ** 2 / blocks)
    slopes = np.diff(squares, axis=0) / np.diff(walked)[:, None]
    unit = unit_of(slopes)
    return Growth(
        series / (walked[lags.last] - walked[lags.first]),
        slopes.mean(axis=1),
        (slopes / unit).std(axis=1, ddof=1) * unit / math.sqrt(parts),
    )
