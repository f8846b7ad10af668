"""Error of the mean and statistical inefficiency of a correlated series, from autoregressive models of it.

A model of order p predicts a sample from the p samples before it, x_t = Σ a_k x_{t-k} + noise of variance s. Its
spectrum at frequency 0, s/(1 - Σ a_k)², is the variance of the mean times the number of samples. Unlike a sum of
autocorrelations that is cut off, or batches of a fixed length, it does justice to correlation and anticorrelation of
any length that the series can show.

Coefficients: Burg's method, by the lattice recursion of Levinson (Percival & Walden, Spectral Analysis for Physical
Applications, 1993, chapter 9). Several series of one process share their coefficients: all sums run over all of them
(de Waele & Broersen, The Burg algorithm for segments, IEEE Trans. Signal Process. 48, 2876 (2000)). Orders are not
chosen but averaged with the weights of Akaike's corrected criterion (Burnham & Anderson, Model Selection and Multimodel
Inference, 2002), so that the error contains how uncertain the order of a short series is.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from idealgas.jit import njit

LEAST_WEIGHT = 1e-3
"""Orders of a smaller weight, relative to the largest one, are left out."""

BLOCKS = 256
"""Number of blocks that a long series is divided into, or up to twice as many."""

FEWEST = 8
"""Least number of blocks to which a known correlation time shortens a series; it is then known to 27 %."""

NOISE = 1e-12
"""Share of the variance below which what a model leaves unexplained is rounding."""

LEAST = 1e-150
"""Change of a series, in its own unit, whose square may be rounded to 0."""


FEW = 2**14
"""Number of samples whose models NumPy finds in much less time than loading numba takes."""


class Model(NamedTuple):
    """Autoregressive model of order p of a series of n samples.

    coefficients: (p,), the a_k. noise: mean square of the noise that the model leaves of the series. covariance:
    (p + 1,), autocovariances of the process at lags 0 to p, with the variance of the noise by n - p degrees of freedom.
    variance_of_log: variance of the estimate of the logarithm of the spectrum at frequency 0.
    """

    coefficients: np.ndarray
    noise: float
    covariance: np.ndarray
    variance_of_log: float


class Spread(NamedTuple):
    """Standard error of the mean of a series, and number of independent samples that would give it as precisely."""

    error: float
    samples: float


@dataclass(frozen=True)
class Process:
    """Stationary process behind one or several series of one length: models with their weights."""

    models: tuple[Model, ...]
    weights: np.ndarray
    length: int

    def covariances(self, length: int) -> np.ndarray:
        """Autocovariances (length,) from lag 0 on, averaged over the models."""
        return np.asarray(
            sum(w * each for w, each in zip(self.weights, self.covariances_of_models(length), strict=True))
        )

    def covariances_of_models(self, length: int) -> np.ndarray:
        """Autocovariances (models, length) from lag 0 on by each model."""
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
        """Standard error of the mean of so many successive samples, by default of all of the series.

        If the spectrum at frequency 0 is known as well as from ν independent samples, the mean, which was subtracted,
        has taken one of them: Bessel's correction has ν in place of n.
        """
        logs = np.log(variance_of_mean(self.covariances_of_models(number or self.length))[:, -1])
        middle = float(self.weights @ logs)
        doubt = np.array([model.variance_of_log for model in self.models]) + (logs - middle) ** 2
        samples = max(2 / float(self.weights @ doubt), 2.0)
        return Spread(math.sqrt(math.exp(middle) * samples / (samples - 1)), samples)


def variance_of_mean(covariance: np.ndarray) -> np.ndarray:
    """Variance (…, n) of the mean of 1 to n successive samples from autocovariances (…, n) at lags 0 to n - 1."""
    n = np.arange(1, covariance.shape[-1] + 1)
    return np.asarray((2 * np.cumsum(np.cumsum(covariance, axis=-1), axis=-1) - n * covariance[..., :1]) / n**2)


def error_of_mean(series: np.ndarray, number: int | None = None, memory: float = 0.0) -> Spread:
    """Standard error of the mean of a stationary series (n,).

    Not a number for fewer than two samples, or where the series is not constant but its squares are 0.

    number: of successive samples, if not all are averaged; their fluctuations are those of the whole series.
    memory: number of samples per independent one by the slowest fluctuations, if it is known, else 0.

    A long series is averaged in blocks first: what matters are the slow fluctuations, which may be too small to be seen
    beside the fast ones. Where the slowest ones are known, blocks are a quarter of `memory`, about their correlation
    time, if FEWEST of them remain: the error has then no more degrees of freedom than slow fluctuations allow.
    """
    n = len(series)
    if n < 2:
        return Spread(math.nan, float(n))
    if is_constant(series):
        return Spread(math.nan if changes(series) else 0.0, float(n))
    block, unit = max(n // BLOCKS, min(int(memory / 4), n // FEWEST), 1), unit_of(series)
    coarse = (series[n % block :] / unit).reshape(-1, block).mean(axis=1)
    if is_constant(coarse):  # all that changes is in the samples that fill no block
        block, coarse = 1, series / unit
    found = process_of(coarse - coarse.mean()).spread(None if number is None else max(number // block, 1))
    return Spread(found.error * unit, found.samples)


def inefficiency(series: np.ndarray) -> float:
    """Statistical inefficiency g ≥ 1 of a stationary process: number of successive samples per independent one.

    g = 1 + 2 Σ (1 - k/n) ρ(k) over the lags k before the first one at which the models' autocorrelation ρ is not
    positive (Chodera et al., J. Chem. Theory Comput. 3, 26 (2007), who estimate ρ without a model). Later, negative
    values are not subtracted: samples that are g apart are decorrelated even if the series oscillates. The error of
    a mean, which does profit from anticorrelation, comes from `error_of_mean`.

    Args:
        series: (n,), one series, or (n, M), series of M members with a common mean, such as the discs of a species.

    Returns:
        g; 1 for fewer than 4 samples and for a constant, n if the members differ but never change.
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
    """Power of two of the size of a series: in this unit squares of large numbers are finite, and digits the same."""
    return float(np.ldexp(1.0, np.frexp(np.abs(series).max())[1] - 1))


def is_constant(series: np.ndarray) -> bool:
    """Whether a series changes by rounding only, or so little that squares of the changes are 0."""
    return not (changes(series) and np.ptp(series) > LEAST)


def changes(series: np.ndarray) -> bool:
    """Whether a series changes by more than rounding."""
    return bool(np.ptp(series) > NOISE * np.abs(series).max())


def process_of(series: np.ndarray) -> Process:
    """Process behind a series (n,) of mean 0 that is not constant, or behind several of them (n, M); n ≥ 2.

    The models have orders from 0 to n/8 or, if the series are long, 20 log₁₀ n.
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
    return Process(models, weight[kept] / weight[kept].sum(), length)


_fitted = 0


def _is_worth_loading() -> bool:
    """Whether compiled functions are used, whose numbers are the same bit for bit."""
    return _fitted > FEW or "numba" in sys.modules


@njit
def _fit(forward, backward, coefficients, noise, covariance, doubt):
    """Fill arrays by order from M series given twice, (n, M), which are lost: numbers of orders that have a model.

    coefficients: (P + 1, P), of order p in row p. noise, covariance: (P + 1,). doubt: (P + 1,), mean square error of
    Σ a_k in units of (1 - Σ a_k)²/(n M).
    """
    n, members = forward.shape
    left = 0.0
    for t in range(n):
        for m in range(members):
            left += forward[t, m] * forward[t, m] / (n * members)
    least = NOISE * left
    covariance[0] = left
    rest = 1.0  # 1 - Σ a_k
    certainty = 0.0  # of Σ a_k: the sum over lower orders of (1 - Σ a_k)²/noise
    for p in range(noise.shape[0]):
        if p > 0:
            both = power = 0.0
            for t in range(p, n):
                for m in range(members):
                    ahead, behind = forward[t, m], backward[t - 1, m]
                    both += ahead * behind
                    power += ahead * ahead + behind * behind
            reflection = 2 * both / power if power > 0 else 0.0
            certainty += rest * rest / left
            covariance[p] = reflection * left
            rest = 1.0 - reflection
            for k in range(p - 1):
                covariance[p] += coefficients[p - 1, k] * covariance[p - 1 - k]
                coefficients[p, k] = coefficients[p - 1, k] - reflection * coefficients[p - 1, p - 2 - k]
                rest -= coefficients[p, k]
            coefficients[p, p - 1] = reflection
            left *= 1 - reflection * reflection
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
    """Fill in the autocovariances (n,) of a model of order p, of which the first p + 1 are known."""
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
    """Do what `_fit` does; sums are those of `cumsum`, which adds one number after the other."""
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
    """Do what `_go_on` does, for several models with their autocovariances (models, n)."""
    orders = np.array([*map(len, coefficients), 0])  # sums over rows of two columns or more are in their order
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
