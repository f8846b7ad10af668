"""Transport coefficients from the growth of integrated currents (Einstein and Helfand).

At times longer than the correlation time of a fluctuating current, the integral G of the current over a time t spreads
like a random walk, ⟨G²⟩ = 2 K t, and the coefficient K is half the slope of ⟨G²⟩. At shorter times half the slope is a
function of t, which equals the Green–Kubo integral of the autocorrelation of the current up to t.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.statistics.autoregression import unit_of

MOST_PARTS = 64
"""Largest number of parts of a run; their scatter gives the standard error at every lag."""


class Lags(NamedTuple):
    """Lags in steps of equal width; the last of them form the plateau.

    Attributes:
        width: width of a step, equal to the width of a block, time.
        first: number of steps before the plateau, 0 < first < last.
        last: total number of steps.
    """

    width: float
    first: int
    last: int

    @property
    def plateau(self) -> tuple[float, float]:
        """First and last lags of the plateau, time."""
        return self.first * self.width, self.last * self.width

    @property
    def times(self) -> np.ndarray:
        """Middles of the steps, (last,), time."""
        return (np.arange(self.last) + 0.5) * self.width


class Growth(NamedTuple):
    """Half the slope of ⟨G²⟩ for one current or for several equivalent currents (routes).

    Attributes:
        series: (routes, n), half the slope over the plateau for each of n starting times, by route.
        running: (last,), half the slope at `Lags.times`, averaged over starting times and routes.
        error: (last,), standard error of `running`.
    """

    series: np.ndarray
    running: np.ndarray
    error: np.ndarray


def lags_of(width: float, longest: float, share: float) -> Lags:
    """Return lags in steps of a given width.

    Args:
        width: width of a step, time.
        longest: approximate longest lag, time.
        share: lag at which the plateau begins, as a fraction of the longest lag.
    """
    last = max(round(longest / width), 2)
    return Lags(width, min(max(round(share * last), 1), last - 1), last)


def growth(flow: np.ndarray, lags: Lags) -> Growth:
    """Return the growth of currents, given their integrals (routes, B) over successive blocks.

    The mean current of the run is subtracted. This reduces ⟨G²⟩ by a fraction t/τ in a run of length τ, for which the
    result is corrected.
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
