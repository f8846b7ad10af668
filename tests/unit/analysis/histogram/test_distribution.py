"""Distributions from counts by hand: densities, their errors, tests against laws, and cumulants of numbers."""

import numpy as np
import pytest
from helpers.logs import raised

from idealgas.analysis.histogram.distribution import distribution_of
from idealgas.analysis.histogram.intervals import _third, _variance
from idealgas.statistics.estimates import Estimate, ks_p_value, ratio
from idealgas.theory.distributions import UniformLaw

pytestmark = pytest.mark.interpreted

COUNTS = np.array([[0, 3, 1, 0], [1, 2, 0, 1]] * 8)  # in 16 blocks: below, from 0 to 0.5, from 0.5 to 2, above


def made(samples=(0.25, 0.5), law_error=0.0, counts=COUNTS):
    average = Estimate(0.5, 0.1, 9.0)
    laws = {"even": UniformLaw()}
    return distribution_of("gas", np.array([0.0, 0.5, 2.0]), counts, average, np.array(samples), 3.0, laws, law_error)


def test_densities_are_shares_of_all_counts_over_the_widths():
    """Of 64 counts 40 and 8 are in the bins; 8 blocks with a value are too few for the error of the second."""
    result = made()
    assert result.density == pytest.approx([40 / 64 / 0.5, 8 / 64 / 1.5], rel=1e-14)
    assert result.middles.tolist() == [0.25, 1.25]
    error = ratio(COUNTS[:, 1].astype(float), COUNTS.sum(axis=1).astype(float)).standard_error
    assert result.error[0] == pytest.approx(error / 0.5, rel=1e-14)
    assert error > 0
    assert np.isnan(result.error[1])
    assert (result.samples, result.correlation_time, result.mean.value) == (2, 3.0, 0.5)
    assert result.laws["even"].tolist() == [1.0, 0.0]


def test_distances_from_a_law_and_its_error():
    """Of 0.25 and 0.5 from the even law: 0.5; less an error of 0.1 of the law itself."""
    (test,) = made().tests
    assert (test.law_name, test.distance, test.law_error) == ("even", 0.5, 0.0)
    assert test.p_value == ks_p_value(0.5, 2)
    (test,) = made(law_error=0.1).tests
    assert test.p_value == ks_p_value(0.4, 2)
    (test,) = made(law_error=0.7).tests
    assert test.p_value == ks_p_value(0.0, 2)


def test_without_counts_there_is_none():
    for nothing in ({"counts": np.zeros((4, 4), int)}, {"samples": ()}):
        raised("too few events", made, **nothing)


@pytest.mark.parametrize(
    ("values", "variance", "third"),
    [((1, 2, 3), 1 / 3, 0.0), ((0, 0, 3), 2.0, 2.0), ((0, 3, 3), 1.0, -1.0), ((2, 2), 0.0, 0.0)],
)
def test_cumulants_over_the_mean(values, variance, third):
    sums = [sum(value**power for value in values) for power in range(4)]
    assert _variance(*sums[:3]) == pytest.approx(variance, abs=1e-14)
    assert _third(*sums) == pytest.approx(third, abs=1e-14)
