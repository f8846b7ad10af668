"""Estimates with error bars from correlated series.

A series is an observable averaged over consecutive blocks of time. The error of its mean, and how far apart
decorrelated samples are, come from autoregressive models (`autoregression`).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np

from idealgas.analysis.core.autoregression import changes, error_of_mean, inefficiency
from idealgas.analysis.core.fields import OMITTED, as_dict, reported
from idealgas.analysis.core.rounding import with_last_digits
from idealgas.analysis.theory.values import Theory

ENOUGH_REPLICATES = 20
"""Least number of runs whose spread gives the error of their mean; with fewer runs, their own errors do."""

RESAMPLES = 2000
"""Number of samples of a bootstrap."""

LEAST_DOUBT = 1e-4
"""One over the degrees of freedom from which on an error is as good as known by a law."""

FEWEST_BLOCKS = 8
"""Least number of blocks whose scatter gives an error; it is then known to 27 %."""

FEWEST_EVENTS = 8
"""Least number of events whose mean has an error; it is then known to 27 %."""

FULL = 40.0
"""Times in which the change of a store has grown to all that it can be, to the last bit."""


@dataclass(frozen=True)
class Estimate:
    """A measured number with its error bar.

    value: measured value, in the unit of the quantity. standard_error: its standard error in the same unit; nan if
    there are too few samples. independent_samples: number of independent samples that would give the standard error as
    precisely, one more than its degrees of freedom; inf if it is known by a law, or 0 as the quantity is known. theory:
    value expected by theory, in the same unit; None where no theory applies. theory_error: standard deviation of the
    error of that value, in the same unit. blocks: lengths of blocks as shares of the series, and the error by blocks
    of this length over standard_error (`errors_by_blocks`); empty if it is not from a series.
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

        None without theory or without an error bar.
        """
        if self.theory is None or not self.standard_error > 0:
            return None
        return (self.value - self.theory) / math.hypot(self.standard_error, self.theory_error)

    def times(self, factor: float) -> "Estimate":
        """Estimate of the quantity multiplied by a factor."""
        return replace(
            self,
            value=self.value * factor,
            standard_error=self.standard_error * abs(factor),
            theory=None if self.theory is None else self.theory * factor,
            theory_error=self.theory_error * abs(factor),
        )

    def interval(self, level: float = 0.95) -> tuple[float, float]:
        """Confidence interval at a level (0 to 1), by Student's t with independent_samples - 1 degrees of freedom."""
        from scipy import special

        half = special.stdtrit(max(self.independent_samples - 1, 1), 0.5 + level / 2) * self.standard_error
        return self.value - half, self.value + half

    @classmethod
    def from_dict(cls, found: Mapping[str, float | None]) -> "Estimate":
        """Make an estimate again from the values of `as_dict`."""
        value, error, samples = (found[name] for name in ("value", "standard_error", "independent_samples"))
        return cls(
            math.nan if value is None else value,
            math.nan if error is None else error,
            math.inf if samples is None else samples,
            found["theory"],
            found["theory_error"] or 0.0,
        )

    def __str__(self) -> str:
        """Value with its error, theory, and deviation: "1.1092(8), theory 1.10954, −0.4σ"."""
        theory = "" if self.theory is None else f", theory {self.theory:.6g}"
        deviation = "" if self.deviation is None else f", {self.deviation:+.1f}σ".replace("-", "−")
        return f"{with_last_digits(self.value, self.standard_error)}{theory}{deviation}"

    def as_dict(self) -> dict[str, float | None]:
        """Fields and deviation by name, ready for JSON; None for numbers that are not finite."""
        return as_dict(self)


def estimate(
    function: Callable[..., Any], *series: np.ndarray, theory: Theory | float | None = None, memory: float = 0.0
) -> Estimate:
    """Estimate of function(means of the series), with its error by linear propagation of their joint fluctuations.

    The sum of ∂f/∂x_k (x_k - ⟨x_k⟩) is a single correlated series that contains all covariances. Examples: a mean is
    `estimate(lambda a: a, a)`, a ratio `estimate(lambda a, b: a / b, a, b)`. memory: see `error_of_mean`.
    """
    columns = np.array(series, float)
    means = columns.mean(axis=1)
    influence = np.zeros(columns.shape[1])
    with np.errstate(divide="ignore", invalid="ignore"):  # 0/0, if no event was counted, gives not a number
        for k, column in enumerate(columns):
            step = 1e-3 * (column.std() or np.ptp(column))  # squares of tiny numbers are 0
            if step > 0 and changes(column):
                shift = np.zeros(len(means))
                shift[k] = step
                slope = (function(*(means + shift)) - function(*(means - shift))) / (2 * step)
                influence += slope * (column - means[k])
        value = float(function(*means))
    error, samples = error_of_mean(influence, memory=memory)
    return Estimate(value, error, samples, *parts_of(theory), errors_by_blocks(influence, error))


def errors_by_blocks(series: np.ndarray, error: float) -> tuple[tuple[float, float], ...]:
    """Lengths of blocks, as shares of a series (n,), and its error as if blocks were independent, over a given error.

    It grows with the length of the blocks until they are longer than the slowest fluctuation: Flyvbjerg & Petersen,
    J. Chem. Phys. 91, 461 (1989).
    """
    n, length, found = len(series), 1, []
    while error > 0 and n // length >= FEWEST_BLOCKS:
        means = (series[n % length :] / error).reshape(-1, length).mean(axis=1)
        found.append((length / n, float(means.std(ddof=1)) / math.sqrt(len(means))))
        length *= 2
    return tuple(found)


def parts_of(theory: Theory | float | None) -> tuple[float | None, float]:
    """Value and error of a theory; the error of a plain number is 0."""
    return (theory.value, theory.error) if isinstance(theory, Theory) else (theory, 0.0)


def mean(series: np.ndarray, theory: Theory | float | None = None, memory: float = 0.0) -> Estimate:
    """Estimate of the mean of one correlated series; memory: see `error_of_mean`."""
    return estimate(lambda a: a, series, theory=theory, memory=memory)


def mean_of_part(series: np.ndarray, part: np.ndarray) -> Estimate:
    """Estimate of the mean of a few successive samples of a series, with the fluctuations of the whole series.

    series: (n,). part: (n,), whether a sample belongs to the part.
    """
    error, samples = error_of_mean(series, int(part.sum()))
    return Estimate(float(series[part].mean()), error, samples)


def mean_of_flux(
    flux: np.ndarray, bulk: np.ndarray, theory: Theory | float | None = None, stored: float | None = None
) -> Estimate:
    """Estimate of the mean of a flux through a boundary, such as the force on a wall.

    What flows through the boundary of a gas has come through its bulk, or its store has changed: the two series differ
    by the rate at which a bounded quantity of the gas changes, such as its momentum. This rate fluctuates much, back
    and forth with the sound in the box for as long as that lasts, and nearly cancels in the mean. So the error is that
    of the bulk and that of the change of the store between two instants.

    flux, bulk: (n,), both series. stored: variance of the store, in units of (flux x samples)², if a law gives it.
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
    """Number of independent samples for an error from several parts, by Welch and Satterthwaite.

    doubt: sum of (share of the variance)²/(degrees of freedom) over the parts.
    """
    return math.inf if doubt < LEAST_DOUBT else 1 + 1 / doubt


def _change_of_store(rates: np.ndarray, stored: float | None) -> tuple[float, float]:
    """Mean square change of a store, from its rates (n,), over all samples, and its degrees of freedom.

    It is twice the variance in the end. If a law gives the variance, the change grows towards that as in an
    Ornstein-Uhlenbeck process, and at first as the sum of squares of the rates, which a few large ones may make up.
    Else it is the mean square of the store against its start: the variance and the square of how far from the mean the
    store was at the start, which need not be a state that chance would give.
    """
    if stored is None:
        store = np.cumsum(rates)
        return float((store**2).mean()), len(store) / inefficiency(store) - 1
    squares = rates**2
    if not (total := float(squares.sum())) > 0:
        return 0.0, math.inf
    reached = min(total / (2 * stored), FULL)
    share = reached / math.expm1(reached)  # by which the change depends on the rates
    effective = total * (total / float((squares**2).sum()))
    return -2 * stored * math.expm1(-reached), 2 * effective / share**2


def ratio(
    numerator: np.ndarray, denominator: np.ndarray, theory: Theory | float | None = None, memory: float = 0.0
) -> Estimate:
    """Estimate of the ratio of the means of two correlated series; memory: see `error_of_mean`."""
    return estimate(lambda a, b: a / b, numerator, denominator, theory=theory, memory=memory)


def of_events(estimate: Estimate, number: float) -> Estimate:
    """Return an estimate from blocks of time in which `number` events happened, with no more samples than events.

    Blocks without an event do not make an error better known. With fewer than FEWEST_EVENTS there is no error: the
    scatter of a few lengths or times of an unknown distribution decides nothing.
    """
    if number < FEWEST_EVENTS:
        return replace(estimate, standard_error=math.nan, independent_samples=number, blocks=())
    return replace(estimate, independent_samples=min(estimate.independent_samples, number))


def ks_distance(samples: np.ndarray, cdf: Callable[[np.ndarray], np.ndarray]) -> float:
    """Kolmogorov-Smirnov distance: largest difference between the distribution function of samples and that of a law.

    samples: (n,), values. cdf: distribution function of the law.
    """
    law, steps = cdf(np.sort(samples)), np.arange(len(samples) + 1) / len(samples)
    return float(max((steps[1:] - law).max(), (law - steps[:-1]).max()))


def ks_p_value(distance: float, samples: int) -> float:
    """Probability of a Kolmogorov-Smirnov distance of at least this one for so many independent samples of the law.

    Vrbik's correction of the limit, Pioneer J. Theor. Appl. Stat. 15, 15 (2018): off by 0.0025 for 10 samples, 0.0003
    for 50 and less for more. The exact one of SciPy takes half a second to load.
    """
    from scipy import special

    root = math.sqrt(samples)
    scaled = distance * root
    return float(special.kolmogorov(scaled + 1 / (6 * root) + (scaled - 1) / (4 * samples)))


def bootstrap(values: np.ndarray, theory: Theory | float | None = None) -> Estimate:
    """Estimate of the mean of independent values (n,), with its error by bootstrap.

    The bootstrap variance is multiplied by n/(n - 1), as it underestimates the variance of n replicates by this factor:
    Efron & Tibshirani, An Introduction to the Bootstrap (1993), eq. 5.12.
    """
    n = len(values)
    picks = np.random.default_rng(0).integers(n, size=(RESAMPLES, n))
    spread = np.std([values[pick].mean() for pick in picks], ddof=1)
    return Estimate(float(values.mean()), float(spread * np.sqrt(n / (n - 1))), float(n), *parts_of(theory))


def mean_of_replicates(replicates: Sequence[Estimate]) -> Estimate:
    """Mean of one quantity over independent runs; error by bootstrap with enough runs, else from their own errors."""
    values, expected = np.array([r.value for r in replicates]), mean_theory([r.theory for r in replicates])
    shared = sum(r.theory_error for r in replicates) / len(replicates)  # the error of theory is common to all runs
    theory = None if expected is None else Theory(expected, shared, "mean of runs")
    if len(values) >= ENOUGH_REPLICATES:
        return bootstrap(values, theory)
    errors = np.array([r.standard_error for r in replicates])
    whole = math.hypot(*errors)
    doubt = sum((errors / whole) ** 4 / [max(r.independent_samples - 1, 1.0) for r in replicates]) if whole > 0 else 0.0
    return Estimate(float(values.mean()), whole / len(values), _samples_of(doubt), *parts_of(theory))


def mean_theory(theories: Sequence[float | None]) -> float | None:
    """Mean of the theoretical values of all runs; None if one run has no theoretical value."""
    known = [theory for theory in theories if theory is not None]
    return sum(known) / len(known) if len(known) == len(theories) else None
