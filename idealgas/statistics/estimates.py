"""Estimates with error bars from correlated series.

A series is an observable averaged over consecutive blocks of time. The error of its mean, and the spacing of
decorrelated samples, come from autoregressive models (`autoregression`).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np

from idealgas.fields import OMITTED, as_dict, reported
from idealgas.statistics.autoregression import changes, error_of_mean, inefficiency
from idealgas.statistics.rounding import with_last_digits
from idealgas.theory.values import Theory

ENOUGH_REPLICATES = 20
"""Smallest number of runs for which the error of the mean is taken from their scatter, not from their errors."""

RESAMPLES = 2000
"""Number of bootstrap samples."""

LEAST_DOUBT = 1e-4
"""Inverse number of degrees of freedom below which an error is treated as exact."""

FEWEST_BLOCKS = 8
"""Smallest number of blocks from whose scatter an error is estimated; the error is then known to 27 %."""

FEWEST_EVENTS = 8
"""Smallest number of events for which the mean has an error; the error is then known to 27 %."""

FULL = 40.0
"""Time, in relaxation times of a stored quantity, after which its mean square change has converged to the last bit."""


@dataclass(frozen=True)
class Estimate:
    """A measured value with its standard error.

    Attributes:
        value: measured value, in the unit of the quantity.
        standard_error: its standard error, in the same unit; nan if there are too few samples.
        independent_samples: number of independent samples that would give the standard error with the same precision,
            one more than its degrees of freedom; inf if the standard error follows from theory, or is 0 because the
            value is exact.
        theory: theoretical value, in the same unit; None if theory is not available.
        theory_error: standard deviation of the error of `theory`, in the same unit.
        blocks: block lengths as fractions of the series, each with the error estimated from blocks of this length over
            standard_error (`errors_by_blocks`); empty if the estimate is not from a series.
    """

    value: float
    standard_error: float
    independent_samples: float
    theory: float | None = None
    theory_error: float = 0.0
    blocks: Annotated[tuple[tuple[float, float], ...], OMITTED] = field(default=(), compare=False, repr=False)

    @property
    @reported
    def deviation(self) -> float | None:
        """Deviation value - theory in units of √(standard_error² + theory_error²).

        None if there is no theoretical value or no error bar.
        """
        if self.theory is None or not self.standard_error > 0:
            return None
        return (self.value - self.theory) / math.hypot(self.standard_error, self.theory_error)

    def times(self, factor: float) -> "Estimate":
        """Return the estimate of the quantity multiplied by a factor."""
        return replace(
            self,
            value=self.value * factor,
            standard_error=self.standard_error * abs(factor),
            theory=None if self.theory is None else self.theory * factor,
            theory_error=self.theory_error * abs(factor),
        )

    def over(self, other: "Estimate") -> "Estimate":
        """Return the ratio to an independent estimate; the errors of both theoretical values have the same cause."""
        value, theory = self.value / other.value, self.theory / other.theory if self.theory and other.theory else None
        error = math.hypot(self.standard_error, (theory or value) * other.standard_error) / abs(other.value)
        doubt = max(each.theory_error / abs(each.theory or math.inf) for each in (self, other))
        samples = min(self.independent_samples, other.independent_samples)
        return Estimate(value, error, samples, theory, abs(theory or 0.0) * doubt)

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """Return the confidence interval at a given level (0 to 1), from Student's t distribution.

        The number of degrees of freedom is independent_samples - 1.
        """
        from scipy import special

        half = special.stdtrit(max(self.independent_samples - 1, 1), 0.5 + level / 2) * self.standard_error
        return self.value - half, self.value + half

    @classmethod
    def from_dict(cls, values: Mapping[str, float | None]) -> "Estimate":
        """Restore an estimate from the dictionary that `as_dict` returns."""
        value, error, samples = (values[name] for name in ("value", "standard_error", "independent_samples"))
        return cls(
            math.nan if value is None else value,
            math.nan if error is None else error,
            math.inf if samples is None else samples,
            values["theory"],
            values["theory_error"] or 0.0,
        )

    def __str__(self) -> str:
        """Return the value with its error, theoretical value and deviation: "1.1092(8), theory 1.10954, −0.4σ"."""
        theory = "" if self.theory is None else f", theory {self.theory:.6g}"
        deviation = "" if self.deviation is None else f", {self.deviation:+.1f}σ".replace("-", "−")
        return f"{with_last_digits(self.value, self.standard_error)}{theory}{deviation}"

    def as_dict(self) -> dict[str, float | None]:
        """Return the fields and the deviation by name, ready for JSON; numbers that are not finite are None."""
        return as_dict(self)


def estimate(
    function: Callable[..., Any], *series: np.ndarray, theory: Theory | float | None = None, memory: float = 0.0
) -> Estimate:
    """Return the estimate of function(means of the series), with linear propagation of their joint fluctuations.

    The sum of ∂f/∂x_k (x_k - ⟨x_k⟩) is a single correlated series that contains all covariances. For example, the mean
    of a is `estimate(lambda a: a, a)`, and a ratio is `estimate(lambda a, b: a / b, a, b)`. memory: see
    `error_of_mean`.
    """
    columns = np.array(series, float)
    means = columns.mean(axis=1)
    influence = np.zeros(columns.shape[1])
    with np.errstate(divide="ignore", invalid="ignore"):  # if no event was counted, 0/0 gives nan
        for k, column in enumerate(columns):
            step = 1e-3 * (column.std() or np.ptp(column))  # the standard deviation of tiny numbers may be 0
            if step > 0 and changes(column):
                shift = np.zeros(len(means))
                shift[k] = step
                slope = (function(*(means + shift)) - function(*(means - shift))) / (2 * step)
                influence += slope * (column - means[k])
        value = float(function(*means))
    error, samples = error_of_mean(influence, memory=memory)
    return Estimate(value, error, samples, *parts_of(theory), errors_by_blocks(influence, error))


def errors_by_blocks(series: np.ndarray, error: float) -> tuple[tuple[float, float], ...]:
    """Return block lengths, as fractions of a series (n,), and the errors if blocks of each length were independent.

    The errors are relative to a given error. They grow with the block length until this exceeds the correlation time of
    the slowest fluctuations: Flyvbjerg & Petersen, J. Chem. Phys. 91, 461 (1989).
    """
    n, length, errors = len(series), 1, []
    while error > 0 and n // length >= FEWEST_BLOCKS:
        means = (series[n % length :] / error).reshape(-1, length).mean(axis=1)
        errors.append((length / n, float(means.std(ddof=1)) / math.sqrt(len(means))))
        length *= 2
    return tuple(errors)


def parts_of(theory: Theory | float | None) -> tuple[float | None, float]:
    """Return a theoretical value and its error; a plain number has error 0."""
    return (theory.value, theory.error) if isinstance(theory, Theory) else (theory, 0.0)


def mean(series: np.ndarray, theory: Theory | float | None = None, memory: float = 0.0) -> Estimate:
    """Return the estimate of the mean of a correlated series; memory: see `error_of_mean`."""
    return estimate(lambda a: a, series, theory=theory, memory=memory)


def mean_of_part(series: np.ndarray, part: np.ndarray) -> Estimate:
    """Return the estimate of the mean of some successive samples, with the fluctuations of the whole series.

    series: (n,). part: (n,), whether each sample is included.
    """
    error, samples = error_of_mean(series, int(part.sum()))
    return Estimate(float(series[part].mean()), error, samples)


def mean_of_flux(
    flux: np.ndarray, bulk: np.ndarray, theory: Theory | float | None = None, stored: float | None = None
) -> Estimate:
    """Return the estimate of the mean of a flux through a boundary, such as the force on a wall.

    The flux through the boundary of a gas and the flux through its bulk differ only by the rate of change of a bounded
    quantity that is stored in the gas, such as momentum. This rate fluctuates strongly, because sound travels back and
    forth in the box, but it nearly cancels in the mean. The error is therefore computed from the error of the bulk flux
    and the change in the stored quantity between the start and the end.

    Args:
        flux: (n,), flux through the boundary.
        bulk: (n,), flux through the bulk.
        theory: theoretical value of the mean.
        stored: variance of the stored quantity, in units of (flux x samples)², if it is known from theory.
    """
    error, samples = error_of_mean(bulk)
    change, known = _change_of_store(flux - bulk, stored)
    whole = math.hypot(error, math.sqrt(change) / len(flux))
    if not whole > 0:
        return Estimate(float(flux.mean()), whole, samples, *parts_of(theory))
    blocks = errors_by_blocks(flux - flux.mean(), whole)
    share = (error / whole) ** 2
    doubt = share**2 / max(samples - 1, 1.0) + (1 - share) ** 2 / max(known, 1.0)
    return Estimate(float(flux.mean()), whole, _samples_of(doubt), *parts_of(theory), blocks)


def _samples_of(doubt: float) -> float:
    """Return the number of independent samples for an error with several terms, after Welch and Satterthwaite.

    doubt: sum of (fraction of the variance)²/(degrees of freedom) over the terms.
    """
    return math.inf if doubt < LEAST_DOUBT else 1 + 1 / doubt


def _change_of_store(rates: np.ndarray, stored: float | None) -> tuple[float, float]:
    """Return the mean square change in a stored quantity from its rates (n,), and its degrees of freedom.

    The change is that between the start and the end of the series. In the limit of long times it is twice the variance.
    If the variance is known from theory, the change approaches this limit as in an Ornstein-Uhlenbeck process;
    initially it grows as the sum of the squared rates, to which a few large rates may contribute most. Otherwise it is
    the mean square of the stored quantity relative to its initial value: the variance plus the square of the initial
    deviation from the mean, which need not be a typical fluctuation.
    """
    if stored is None:
        store = np.cumsum(rates)
        return float((store**2).mean()), len(store) / inefficiency(store) - 1
    squares = rates**2
    if not (total := float(squares.sum())) > 0:
        return 0.0, math.inf
    reached = min(total / (2 * stored), FULL)
    share = reached / math.expm1(reached)  # weight of the rates in the change
    effective = total * (total / float((squares**2).sum()))
    return -2 * stored * math.expm1(-reached), 2 * effective / share**2


def ratio(
    numerator: np.ndarray, denominator: np.ndarray, theory: Theory | float | None = None, memory: float = 0.0
) -> Estimate:
    """Return the estimate of the ratio of the means of two correlated series; memory: see `error_of_mean`."""
    return estimate(lambda a, b: a / b, numerator, denominator, theory=theory, memory=memory)


def of_events(estimate: Estimate, number: float) -> Estimate:
    """Return an estimate from blocks of time that contain `number` events, with no more samples than events.

    Blocks without an event do not make an error more precise. With fewer than FEWEST_EVENTS events there is no error,
    because the scatter of a few values from an unknown distribution is not conclusive.
    """
    if number < FEWEST_EVENTS:
        return replace(estimate, standard_error=math.nan, independent_samples=number, blocks=())
    return replace(estimate, independent_samples=min(estimate.independent_samples, number))


def ks_distance(samples: np.ndarray, cdf: Callable[[np.ndarray], np.ndarray]) -> float:
    """Return the Kolmogorov-Smirnov distance: the largest difference between two distribution functions.

    samples: (n,), values, which define the empirical distribution function. cdf: distribution function of theory.
    """
    law, steps = cdf(np.sort(samples)), np.arange(len(samples) + 1) / len(samples)
    return float(max((steps[1:] - law).max(), (law - steps[:-1]).max()))


def ks_p_value(distance: float, samples: int) -> float:
    """Return the probability of a Kolmogorov-Smirnov distance of at least this size, for independent samples.

    The samples are assumed to follow the theoretical distribution. The limiting distribution is used with Vrbik's
    correction, Pioneer J. Theor. Appl. Stat. 15, 15 (2018), whose error is 0.0025 for 10 samples, 0.0003 for 50, and
    smaller for more. Loading the exact function from SciPy takes half a second.
    """
    from scipy import special

    root = math.sqrt(samples)
    scaled = distance * root
    return float(special.kolmogorov(scaled + 1 / (6 * root) + (scaled - 1) / (4 * samples)))


def bootstrap(values: np.ndarray, theory: Theory | float | None = None) -> Estimate:
    """Return the estimate of the mean of independent values (n,), with a bootstrap error.

    The bootstrap variance is multiplied by n/(n - 1), because it underestimates the variance of n replicates by this
    factor: Efron & Tibshirani, An Introduction to the Bootstrap (1993), eq. 5.12.
    """
    n = len(values)
    picks = np.random.default_rng(0).integers(n, size=(RESAMPLES, n))
    spread = np.std([values[pick].mean() for pick in picks], ddof=1)
    return Estimate(float(values.mean()), float(spread * np.sqrt(n / (n - 1))), float(n), *parts_of(theory))


def mean_of_replicates(replicates: Sequence[Estimate]) -> Estimate:
    """Return the mean of a quantity over independent runs.

    The error is estimated by bootstrap if there are enough runs, and otherwise from the errors of the runs.
    """
    values, expected = np.array([r.value for r in replicates]), mean_theory([r.theory for r in replicates])
    shared = sum(r.theory_error for r in replicates) / len(replicates)  # all runs share this error
    theory = None if expected is None else Theory(expected, shared, "mean of runs")
    if len(values) >= ENOUGH_REPLICATES:
        return bootstrap(values, theory)
    errors = np.array([r.standard_error for r in replicates])
    whole = math.hypot(*errors)
    doubt = sum((errors / whole) ** 4 / [max(r.independent_samples - 1, 1.0) for r in replicates]) if whole > 0 else 0.0
    return Estimate(float(values.mean()), whole / len(values), _samples_of(doubt), *parts_of(theory))


def mean_theory(theories: Sequence[float | None]) -> float | None:
    """Return the mean of the theoretical values of all runs; None if a run has no theoretical value."""
    known = [theory for theory in theories if theory is not None]
    return sum(known) / len(known) if len(known) == len(theories) else None
