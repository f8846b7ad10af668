"""Binned distribution of one quantity with error bars, and tests against laws."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np

from idealgas.analysis.check import PValue
from idealgas.errors import UserError
from idealgas.fields import OMITTED, OPTIONAL, Key, reported
from idealgas.statistics.estimates import Estimate, ks_distance, ks_p_value, ratio
from idealgas.theory import distributions

BINS = 120
"""Number of bins for a continuous quantity."""

ALL_DISCS = "all discs"
"""Name of a distribution that covers all discs instead of a single species."""

FEWEST_BLOCKS = 10
"""Smallest effective number of time blocks that contribute to a bin for which its error bar is given."""


@dataclass(frozen=True)
class Test:
    """Kolmogorov-Smirnov test of samples against a law.

    Attributes:
        law_name: name of the law.
        law: the law.
        distance: largest difference between the distribution functions, no unit.
        law_error: largest error of the theoretical distribution function, no unit.
        p_value: probability of at least this distance by chance, allowing for `law_error`.
        agrees: whether the samples agree with the law; None if there are too few samples for a verdict.
    """

    law_name: Annotated[str, Key("law")]
    law: Annotated[distributions.Law, OMITTED]
    distance: float
    law_error: float
    p_value: float
    agrees: bool | None = None


@dataclass(frozen=True)
class Distribution:
    """Distribution of one quantity for one species, or for the whole gas.

    Attributes:
        name: name of the species, or ALL_DISCS.
        edges: (bins + 1,), edges of the bins, in the unit of the quantity.
        density: (bins,), probability density, 1/unit.
        error: (bins,), standard error of the density, 1/unit; nan for a bin to which too few time blocks contribute.
        mean: mean of the quantity.
        samples: number of independent samples.
        correlation_time: time between independent samples; None for quantities other than velocities and energies.
        tests: test against each law.
        counted_in: duration over which collisions are counted, time; None for other quantities.
        cumulants: cumulants of the number of collisions, divided by the mean number, by name (no unit).
    """

    name: str
    edges: np.ndarray
    density: np.ndarray
    error: np.ndarray
    mean: Estimate
    samples: int
    correlation_time: float | None
    tests: tuple[Test, ...]
    counted_in: Annotated[float | None, OPTIONAL] = None
    cumulants: dict[str, Estimate] = field(default_factory=dict)

    @property
    def middles(self) -> np.ndarray:
        """Centres of the bins, (bins,), in the unit of the quantity."""
        return (self.edges[1:] + self.edges[:-1]) / 2

    def judged(self, rows: int) -> "Distribution":
        """Return the distribution with verdicts added to its tests, for a comparison of `rows` rows."""
        verdicts = (replace(test, agrees=PValue(test.p_value, self.samples).agrees(rows)) for test in self.tests)
        return replace(self, tests=tuple(verdicts))

    @property
    @reported
    def laws(self) -> dict[str, np.ndarray]:
        """Probability density of each law at the centres of the bins, (bins,), 1/unit."""
        return {test.law_name: test.law.pdf(self.middles) for test in self.tests}


def distribution_of(
    name: str,
    edges: np.ndarray,
    counts: np.ndarray,
    average: Estimate,
    samples: np.ndarray,
    correlation_time: float | None,
    possible: Mapping[str, distributions.Law],
    law_error: float = 0.0,
) -> Distribution:
    """Return a distribution from counts and samples.

    Args:
        name: name of the species, or ALL_DISCS.
        edges: (bins + 1,), edges of the bins.
        counts: (B, bins + 2), counts in B time blocks; the first and the last bins count the values outside the edges.
        average: mean of the quantity.
        samples: (n,), independent samples.
        correlation_time: time between the samples; None for quantities other than velocities and energies.
        possible: laws by name.
        law_error: largest error of the distribution functions of the laws.

    Raises:
        UserError: if all counts are zero or there are no samples.
    """
    if not (total := counts.sum(axis=1)).any() or len(samples) == 0:
        raise UserError(f"too few events in the window for a distribution of {name}")
    share = counts[:, 1:-1].sum(axis=0) / total.sum()
    error = np.array([_error(column, total) for column in counts[:, 1:-1].T])
    tests = []
    for law_name, law in possible.items():
        distance = ks_distance(samples, law.cdf)
        p_value = ks_p_value(max(distance - law_error, 0.0), len(samples))
        tests.append(Test(law_name, law, distance, law_error, p_value))
    width, number = np.diff(edges), len(samples)
    return Distribution(name, edges, share / width, error / width, average, number, correlation_time, tuple(tests))


def _error(count: np.ndarray, total: np.ndarray) -> float:
    """Return the standard error of the fraction of values in a bin.

    The result is nan if too few time blocks contribute to the bin.

    Args:
        count: (B,), counts in the bin in B time blocks.
        total: (B,), counts in all bins.
    """
    part = count / total.sum()
    known = part.sum() ** 2 > FEWEST_BLOCKS * (part**2).sum()
    return ratio(count, total).standard_error if known else np.nan
