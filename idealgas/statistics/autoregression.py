"""Standard error of the mean and statistical inefficiency of a correlated series, from autoregressive models.

A model of order p predicts a sample from the p samples before it, x_t = Σ a_k x_{t-k} + noise of variance s. Its
spectrum at frequency 0, s/(1 - Σ a_k)², is the variance of the mean times the number of samples. Unlike a truncated sum
of autocorrelations or batches of a fixed length, it accounts for positive and negative correlations of any length that
the series can resolve.

The coefficients are computed with Burg's method, by the lattice recursion of Levinson (Percival & Walden, Spectral
Analysis for Physical Applications, 1993, chapter 9). Several series of the same process share their coefficients, and
all sums run over all series (de Waele & Broersen, The Burg algorithm for segments, IEEE Trans. Signal Process. 48, 2876
(2000)). Instead of selecting an order, the results of all orders are averaged with the weights of Akaike's corrected
criterion (Burnham & Anderson, Model Selection and Multimodel Inference, 2002), so that the error of a short series
includes the uncertainty of the order.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from idealgas.jit import njit

LEAST_WEIGHT = 1e-3
"""Weight, relative to the largest one, below which orders are omitted."""

BLOCKS = 256
"""Number of blocks into which a long series is divided; the actual number may be up to twice as large."""

FEWEST = 8
"""Smallest number of blocks into which a series of known correlation time is divided, for an error known to 27 %."""

NOISE = 1e-12
"""Fraction of the variance below which the residual of a model is attributed to rounding."""

LEAST = 1e-150
"""Change in a series, in its own unit, whose square may be rounded to 0."""


FEW = 2**14
"""Number of samples up to which fitting the models with NumPy takes much less time than loading numba."""


class Model(NamedTuple):
    """Autoregressive model of order p of a series of n samples.

    Attributes:
        coefficients: (p,), the a_k.
        noise: mean square residual of the model.
        covariance: (p + 1,), autocovariances of the process at lags 0 to p, with n - p degrees of freedom for the
            variance of the noise.
        variance_of_log: variance of the estimate of the logarithm of the spectrum at frequency 0.
    """

    coefficients: np.ndarray
    noise: float
    covariance: np.ndarray
    variance_of_log: float


class Spread(NamedTuple):
    """Standard error of the mean of a series, and the number of independent samples with an equally precise error."""

    error: float
    samples: float


@dataclass(frozen=True)
class AutoregressiveProcess:
    """Stationary process from which one or several series of equal length are drawn: models with their weights."""

    models: tuple[Model, ...]
    weights: np.ndarray
    length: int

    def covariances(self, length: int) -> np.ndarray:
        """Return the autocovariances (length,) at lags 0, 1, …, averaged over the models."""
        return np.asarray(
            sum(w * each for w, each in zip(self.weights, self.covariances_of_models(length), strict=True))
        )

    def covariances_of_models(self, length: int) -> np.ndarray:
        """Return the autocovariances (models, length) of each model at lags 0, 1, …."""
        covariances = np.zeros((len(self.models), length))
        for model, row in zip(self.models, covariances, strict=True):
            known = model.covariance[:length]
            row[: len(known)] = known
        if _is_worth_loading():
            for model, row in zip(self.models, covariances, strict=True):
                _go_on(model.coefficients, row)
        else:
            _go_on_together([model.coefficients for model in self.models], covariances)
        return covariances

    def spread(self, number: int | None = None) -> Spread:
        """Return the standard error of the mean of `number` successive samples, by default of the whole series.

        If the spectrum at frequency 0 is known as precisely as from ν independent samples, subtracting the mean has
        used up one of these samples, so that Bessel's correction contains ν instead of n.
        """
        logs = np.log(variance_of_mean(self.covariances_of_models(number or self.length))[:, -1])
        middle = float(self.weights @ logs)
        doubt = np.array([model.variance_of_log for model in self.models]) + (logs - middle) ** 2
        samples = max(2 / float(self.weights @ doubt), 2.0)
        return Spread(math.sqrt(math.exp(middle) * samples / (samples - 1)), samples)


def variance_of_mean(covariance: np.ndarray) -> np.ndarray:
    """Return variances (…, n) of means of 1 to n successive samples from autocovariances (…, n) at lags 0 to n - 1."""
    n = np.arange(1, covariance.shape[-1] + 1)
    return np.asarray((2 * np.cumsum(np.cumsum(covariance, axis=-1), axis=-1) - n * covariance[..., :1]) / n**2)


def error_of_mean(series: np.ndarray, number: int | None = None, memory: float = 0.0) -> Spread:
    """Return the standard error of the mean of a stationary series (n,).

    The result is nan for fewer than two samples, and if the series changes by so little that the squares of the changes
    are 0.

    A long series is first averaged in blocks, because the error is determined by slow fluctuations, which may be too
    small to be visible beside fast ones. If the slowest fluctuations are known, the block length is a quarter of
    `memory`, about their correlation time, provided that at least FEWEST blocks remain. The error then has no more
    degrees of freedom than slow fluctuations allow.

    Args:
        series: (n,), values.
        number: number of successive samples that are averaged, by default all; their fluctuations are those of the
            series.
        memory: number of samples per independent sample of the slowest fluctuations if known, otherwise 0.
    """
    n = len(series)
    if n < 2:
        return Spread(math.nan, float(n))
    if is_constant(series):
        return Spread(math.nan if changes(series) else 0.0, float(n))
    block, unit = max(n // BLOCKS, min(int(memory / 4), n // FEWEST), 1), unit_of(series)
    coarse = (series[n % block :] / unit).reshape(-1, block).mean(axis=1)
    if is_constant(coarse):  # all changes are in the last samples, which do not fill a block
        block, coarse = 1, series / unit
    spread = process_of(coarse - coarse.mean()).spread(None if number is None else max(number // block, 1))
    return Spread(spread.error * unit, spread.samples)


def inefficiency(series: np.ndarray) -> float:
    """Return the statistical inefficiency g ≥ 1 of a stationary process, the number of samples per independent sample.

    g = 1 + 2 Σ (1 - k/n) ρ(k) over the lags k before the first lag at which the autocorrelation ρ of the models is not
    positive (Chodera et al., J. Chem. Theory Comput. 3, 26 (2007), who estimate ρ without a model). Later negative
    values are not subtracted: samples that are g apart are decorrelated even if the series oscillates. For the error of
    a mean, which anticorrelation does reduce, use `error_of_mean`.

    Args:
        series: (n,), one series, or (n, M), series of M members with a common mean, such as the discs of a species.

    Returns:
        g; 1 for fewer than 4 samples and for a constant series, n if the members differ but never change.
    """
    n = len(series)
    if n < 4 or is_constant(series):
        return 1.0
    if np.ptp(series, axis=0).max() <= NOISE * np.abs(series).max():
        return float(n)
    scaled = series / unit_of(series)
    covariance = process_of(scaled - scaled.mean()).covariances(n)
    ends = np.flatnonzero(covariance <= 0)
    lags = np.arange(1, ends[0] if len(ends) else n)
    return float(1 + 2 * ((1 - lags / n) * covariance[lags]).sum() / covariance[0])


def unit_of(series: np.ndarray) -> float:
    """Return the order of magnitude of a series as a power of two.

    In this unit the squares of large numbers are finite, and the digits do not change.
    """
    return float(np.ldexp(1.0, np.frexp(np.abs(series).max())[1] - 1))


def is_constant(series: np.ndarray) -> bool:
    """Return whether a series is constant except for rounding, or for changes whose squares underflow to 0."""
    return not (changes(series) and np.ptp(series) > LEAST)


def changes(series: np.ndarray) -> bool:
    """Return whether a series changes by more than rounding errors."""
    return bool(np.ptp(series) > NOISE * np.abs(series).max())


def process_of(series: np.ndarray) -> AutoregressiveProcess:
    """Return the process of a series (n,) of mean 0, or of several such series (n, M).

    The series must not be constant, and n ≥ 2. The orders of the models are 0 to n/8 or, for long series, 0 to 20 log₁₀
    n.
    """
    global _fitted
    _fitted += series.size
    length, n = len(series), series.size
    most = min(length // 8, int(20 * math.log10(length)))
    coefficients = np.zeros((most + 1, most))
    noise, covariance, doubt = np.zeros((3, most + 1))
    forward, backward = np.array([series.reshape(length, -1)] * 2, float)
    fit = _fit if _is_worth_loading() else _fit_in_numpy
    number = fit(forward, backward, coefficients, noise, covariance, doubt)
    orders = np.arange(number)
    criterion = n * np.log(noise[:number]) + 2 * (orders + 1) * n / np.maximum(n - orders - 2, 0.5)
    weight = np.exp((criterion.min() - criterion) / 2)
    kept = np.flatnonzero(weight >= LEAST_WEIGHT)
    models = tuple(
        Model(coefficients[p, :p], noise[p], covariance[: p + 1] * n / (n - p), 2 / n + 4 * doubt[p] / n)
        for p in kept.tolist()
    )
    return AutoregressiveProcess(models, weight[kept] / weight[kept].sum(), length)


_fitted = 0


def _is_worth_loading() -> bool:
    """Return whether compiled functions are used; their results are bit-identical."""
    return _fitted > FEW or "numba" in sys.modules


@njit
def _fit(forward, backward, coefficients, noise, covariance, doubt):
    """Fit models to M series and return the number of orders for which there is a model.

    The series are passed twice, as (n, M), and overwritten. The other arrays are filled by order. coefficients: (P + 1,
    P), row p for order p. noise, covariance: (P + 1,). doubt: (P + 1,), mean square error of Σ a_k in units of (1 - Σ
    a_k)²/(n M).

    A model of order p - 1 predicts a sample x_t from the samples before it, with the error f_t and, since a stationary
    process has the same covariances backwards in time, x_{t-p} from the same samples with the error b_{t-1}:

        x_{t-p}    x_{t-p+1} … x_{t-1}    x_t
           ↑       └─ known samples ─┘     ↑
        b_{t-1}                           f_t

    The two samples at the ends are new to a model of order p, and the only additional information is in the correlation
    of their errors. Order p follows from order p - 1 in three steps:

    1. κ = 2 Σ f_t b_{t-1}/Σ (f_t² + b_{t-1}²) minimises the sum of the squares of both new errors. Because |2 f b| is
       at most f² + b², |κ| is at most 1, so that no model grows with time.
    2. a_k ← a_k - κ a_{p-k} for k < p, and a_p = κ; the covariance at lag p is κ s + Σ a_k c_{p-k} with the old a_k and
       the old noise s, which becomes s (1 - κ²).
    3. f_t ← f_t - κ b_{t-1} and b_t ← b_{t-1} - κ f_t.

    The mean square error of Σ a_k is that of a linear regression, s/(n M) times the sum of all elements of the inverse
    of the covariance matrix of p samples. The errors b of all orders below p are uncorrelated combinations of these
    samples, in which the matrix is diagonal; the sum is then Σ (1 - Σ a_k)²/s over these orders, `certainty`.
    """
    n, members = forward.shape
    left = 0.0  # the noise s
    for t in range(n):
        for m in range(members):
            left += forward[t, m] * forward[t, m] / (n * members)
    least = NOISE * left
    covariance[0] = left
    rest = 1.0  # 1 - Σ a_k
    certainty = 0.0
    for p in range(noise.shape[0]):
        if p > 0:
            # 1. The coefficient κ.
            both = power = 0.0
            for t in range(p, n):
                for m in range(members):
                    ahead, behind = forward[t, m], backward[t - 1, m]
                    both += ahead * behind
                    power += ahead * ahead + behind * behind
            reflection = 2 * both / power if power > 0 else 0.0
            # 2. The model.
            certainty += rest * rest / left
            covariance[p] = reflection * left
            rest = 1.0 - reflection
            for k in range(p - 1):
                covariance[p] += coefficients[p - 1, k] * covariance[p - 1 - k]
                coefficients[p, k] = coefficients[p - 1, k] - reflection * coefficients[p - 1, p - 2 - k]
                rest -= coefficients[p, k]
            coefficients[p, p - 1] = reflection
            left *= 1 - reflection * reflection
            # 3. Its errors; from the last to the first, because each b_t replaces the b_{t-1} before it.
            for t in range(n - 1, p - 1, -1):
                for m in range(members):
                    ahead, behind = forward[t, m], backward[t - 1, m]
                    forward[t, m] = ahead - reflection * behind
                    backward[t, m] = behind - reflection * ahead
        if left <= least:
            return p
        noise[p] = left
        doubt[p] = left * certainty / (rest * rest)
    return noise.shape[0]


@njit
def _go_on(coefficients, covariance):
    """Fill in the autocovariances (n,) of a model of order p, of which the first p + 1 are given."""
    p = coefficients.shape[0]
    for k in range(p + 1, covariance.shape[0]):
        total = 0.0
        for j in range(p):
            total += coefficients[j] * covariance[k - 1 - j]
        covariance[k] = total


def _fit_in_numpy(
    forward: np.ndarray,
    backward: np.ndarray,
    coefficients: np.ndarray,
    noise: np.ndarray,
    covariance: np.ndarray,
    doubt: np.ndarray,
) -> int:
    """Do the same as `_fit`; `cumsum` adds the numbers in the same order."""
    left = (forward * forward / forward.size).cumsum()[-1]
    least, rest, certainty = NOISE * left, np.float64(1.0), 0.0
    covariance[0] = left
    for p in range(len(noise)):
        if p > 0:
            ahead, behind = forward[p:], backward[p - 1 : -1]
            both, power = (ahead * behind).cumsum()[-1], (ahead * ahead + behind * behind).cumsum()[-1]
            reflection = 2 * both / power if power > 0 else 0.0
            certainty += rest * rest / left
            before = coefficients[p - 1, : p - 1]
            coefficients[p, : p - 1] = before - reflection * before[::-1]
            coefficients[p, p - 1] = reflection
            covariance[p] = np.append(reflection * left, before * covariance[p - 1 : 0 : -1]).cumsum()[-1]
            rest = np.subtract.accumulate(np.append(1.0 - reflection, coefficients[p, : p - 1]))[-1]
            left *= 1 - reflection * reflection
            forward[p:], backward[p:] = ahead - reflection * behind, behind - reflection * ahead
        if left <= least:
            return p
        noise[p] = left
        with np.errstate(divide="ignore"):
            doubt[p] = left * certainty / (rest * rest)
    return len(noise)


def _go_on_together(coefficients: Sequence[np.ndarray], covariance: np.ndarray) -> None:
    """Do the same as `_go_on` for several models and their autocovariances (models, n)."""
    orders = np.array([*map(len, coefficients), 0])  # NumPy adds rows in order if they have at least two columns
    most, n = int(orders.max()), covariance.shape[1]
    weights = np.zeros((most, len(orders)))
    padded = np.zeros((most + n, len(orders)))  # with zeros before lag 0
    for k, known in enumerate(coefficients):
        weights[most - len(known) :, k] = known[::-1]
    padded[most:, :-1] = covariance.T
    for lag in range(int(orders[:-1].min()) + 1, n):
        total = np.add.reduce((weights * padded[lag : lag + most])[::-1], axis=0)
        np.copyto(padded[most + lag], total, where=orders < lag)
    covariance[:] = padded[most:, :-1].T
