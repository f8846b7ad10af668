"""Estimates with error bars from correlated series.

A series is an observable averaged over consecutive blocks of time. pymbar measures how many of its samples are
independent (Chodera et al., J. Chem. Theory Comput. 3, 26 (2007)) and where equilibrium begins (Chodera, ibid. 12, 1799
(2016)).
"""

import logging
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from scipy import stats

from idealgas.errors import UserError

logging.getLogger("pymbar").setLevel(logging.ERROR)  # it announces at import that JAX would be faster
from pymbar import timeseries  # noqa: E402

ENOUGH_REPLICATES = 20
"""Independent runs from which the spread among them tells the error; with fewer their own errors do."""

LONG_BLOCKS = 32
"""Blocks that errors of anticorrelated series are taken from."""

TOLERANCE = 4.0
"""Standard errors by which measurement and theory may differ where they are checked."""


@dataclass(frozen=True)
class Estimate:
    """A measured number with its error bar.

    value: in the unit of the quantity. standard_error: of the value, nan if there are too few samples for one.
    independent_samples: number of them that the error comes from, inf for what is known exactly. theory: value that
    theory expects of this gas; None where no theory applies.
    """

    value: float
    standard_error: float
    independent_samples: float
    theory: float | None = None

    @property
    def deviation(self) -> float | None:
        """(value - theory) in standard errors; None without theory or without an error bar."""
        if self.theory is None or not self.standard_error > 0:
            return None
        return (self.value - self.theory) / self.standard_error

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """Confidence interval of a level, 0 to 1, by Student's t with independent_samples - 1 degrees of freedom."""
        half = stats.t.ppf(0.5 + level / 2, max(self.independent_samples - 1, 1)) * self.standard_error
        return self.value - half, self.value + half

    @classmethod
    def from_dict(cls, found: Mapping[str, float | None]) -> "Estimate":
        """What `as_dict` was made from."""
        value, error, samples = (found[name] for name in ("value", "standard_error", "independent_samples"))
        return cls(
            math.nan if value is None else value,
            math.nan if error is None else error,
            math.inf if samples is None else samples,
            found["theory"],
        )

    def as_dict(self) -> dict[str, float | None]:
        """Fields and deviation by name, for JSON: None for what is not finite."""
        fields = asdict(self) | {"deviation": self.deviation}
        return {name: value if value is not None and math.isfinite(value) else None for name, value in fields.items()}


def agree(found: Iterable[Estimate]) -> bool:
    """Whether every value is within TOLERANCE standard errors of its theory. UserError if that cannot be said."""
    deviations = [one.deviation for one in found]
    if any(deviation is None or not math.isfinite(deviation) for deviation in deviations):
        raise UserError("nothing to check: too few events for an error bar, or no theory at this packing fraction")
    return all(abs(deviation) <= TOLERANCE for deviation in deviations if deviation is not None)


def inefficiency(series: np.ndarray) -> float:
    """Statistical inefficiency g ≥ 1: samples per independent sample; 1 for a series too short or constant to tell."""
    if len(series) < 4 or not np.ptp(series) > 1e-12 * np.abs(series).max():
        return 1.0
    return float(timeseries.statistical_inefficiency(series))


def ensemble_inefficiency(series: np.ndarray) -> float:
    """The same from many series of one process, such as all discs of a species. series: (samples, members)."""
    if len(series) < 4 or np.ptp(series) == 0:
        return 1.0
    return float(timeseries.statistical_inefficiency_multiple(list(series.T)))


def equilibration(*series: np.ndarray) -> int:
    """Index from which every series is stationary: the start that leaves the most independent samples."""
    start = 0
    for values in series:
        if len(values) >= 16 and np.ptp(values) > 1e-12 * np.abs(values).max():
            start = max(start, int(timeseries.detect_equilibration(values, nskip=max(1, len(values) // 64))[0]))
    return start


def estimate(function: Callable[..., Any], *series: np.ndarray, theory: float | None = None) -> Estimate:
    """function(mean of each series), its error by linear propagation through the series' joint fluctuations.

    The sum of ∂f/∂x_k (x_k - ⟨x_k⟩) is one correlated series, so that covariances need no bookkeeping: a mean is
    `estimate(lambda a: a, a)`, a ratio `estimate(lambda a, b: a / b, a, b)`.
    """
    columns = np.array(series, float)
    means = columns.mean(axis=1)
    influence = np.zeros(columns.shape[1])
    with np.errstate(divide="ignore", invalid="ignore"):  # a ratio of what never happened is not a number
        for k, column in enumerate(columns):
            if (step := 1e-3 * column.std()) > 0:
                shift = np.zeros(len(means))
                shift[k] = step
                slope = (function(*(means + shift)) - function(*(means - shift))) / (2 * step)
                influence += slope * (column - means[k])
        value = float(function(*means))
    error, samples = _error_of_mean(influence)
    return Estimate(value, error, samples, theory)


def _error_of_mean(series: np.ndarray) -> tuple[float, float]:
    """Standard error and independent samples of a mean.

    Inefficiencies below 1 are beyond pymbar; yet what walls receive swings back and forth with the sound in the box.
    So longer blocks decide where they give an error clearly smaller than chance would (Flyvbjerg & Petersen, J. Chem.
    Phys. 91, 461 (1989)).
    """
    if len(series) < 2:
        return math.nan, float(len(series))
    samples = len(series) / inefficiency(series)
    error = float(series.std(ddof=1) / math.sqrt(samples))
    if len(series) >= 2 * LONG_BLOCKS:
        longer, fewer = _error_of_mean(block_averages(series, LONG_BLOCKS))
        if longer < (1 - 2.5 / math.sqrt(2 * LONG_BLOCKS)) * error:
            return longer, fewer
    return error, samples


def mean(series: np.ndarray, theory: float | None = None) -> Estimate:
    """Mean of one series."""
    return estimate(lambda a: a, series, theory=theory)


def ratio(numerator: np.ndarray, denominator: np.ndarray, theory: float | None = None) -> Estimate:
    """Ratio of two means."""
    return estimate(lambda a, b: a / b, numerator, denominator, theory=theory)


def ks_distance(samples: np.ndarray, cdf: Callable[[np.ndarray], np.ndarray]) -> float:
    """Kolmogorov and Smirnov's distance: the largest between the distribution function of samples and a law's, `cdf`.

    Where its probability by chance is asked for as well, `scipy.stats.kstest` gives both.
    """
    law, steps = cdf(np.sort(samples)), np.arange(len(samples) + 1) / len(samples)
    return float(max((steps[1:] - law).max(), (law - steps[:-1]).max()))


def block_averages(series: np.ndarray, blocks: int) -> np.ndarray:
    """Averages over `blocks` equal stretches of a series; samples that do not fill the last one are left out."""
    length = len(series) // blocks
    return np.asarray(series)[: length * blocks].reshape(blocks, length).mean(axis=1)


def bootstrap(
    replicates: np.ndarray,
    function: Callable[[np.ndarray], float] = np.mean,
    *,
    seed: int = 0,
    resamples: int = 2000,
    theory: float | None = None,
) -> Estimate:
    """function(replicates) with its error from resampling independent replicates (first axis) with replacement.

    The spread of a bootstrap is that of n - 1 degrees of freedom over n, which is made good: Efron & Tibshirani, An
    Introduction to the Bootstrap (1993), eq. 5.12.
    """
    replicates = np.asarray(replicates)
    n = len(replicates)
    picks = np.random.default_rng(seed).integers(n, size=(resamples, n))
    spread = np.std([function(replicates[pick]) for pick in picks], ddof=1)
    return Estimate(float(function(replicates)), float(spread * np.sqrt(n / (n - 1))), float(n), theory)


def mean_of_replicates(replicates: Sequence[Estimate]) -> Estimate:
    """Mean of the same quantity over independent runs: with enough of them by bootstrap, else by their own errors."""
    values, theory = np.array([r.value for r in replicates]), mean_theory([r.theory for r in replicates])
    if len(values) >= ENOUGH_REPLICATES:
        return bootstrap(values, theory=theory)
    error = math.sqrt(sum(r.standard_error**2 for r in replicates)) / len(values)
    return Estimate(float(values.mean()), error, float(sum(r.independent_samples for r in replicates)), theory)


def mean_theory(theories: Sequence[float | None]) -> float | None:
    """Mean of what theory says of each run; None if it is silent on one."""
    known = [theory for theory in theories if theory is not None]
    return sum(known) / len(known) if len(known) == len(theories) else None
