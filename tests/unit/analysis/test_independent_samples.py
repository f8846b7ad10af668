"""Samples of a gas are independent, even where all discs share a fluctuation that outlasts each one's own."""

import numpy as np
import pytest
from scipy import signal, stats

from idealgas.analysis.histogram import independent_samples
from idealgas.analysis.histogram.distribution import distribution_of
from idealgas.statistics.estimates import Estimate
from idealgas.theory.distributions import WaitingTimeLaw

DISCS, INSTANTS, RUNS = 40, 600, 300
LEAST_P = 0.001


def gas(rng, own, shared):
    """Values of discs that are normal and independent at each instant; they and their mean forget at two rates.

    own, shared: correlations from one instant to the next of the differences between discs and of their mean.
    """
    noise = rng.normal(size=(INSTANTS + 200, DISCS))
    mean = noise.mean(axis=1, keepdims=True)
    filtered = [
        signal.lfilter([np.sqrt(1 - memory**2)], [1, -memory], part, axis=0)
        for memory, part in ((own, noise - mean), (shared, mean))
    ]
    return sum(filtered)[200:]


@pytest.mark.parametrize(("own", "shared"), [(0.0, 0.0), (0.5, 0.5), (0.4, 0.9), (0.8, 0.3)])
def test_p_values_are_uniform(own, shared):
    """Of 300 runs. Samples at the statistical inefficiency of single discs have 5e-12 for a shared memory of 0.9."""
    rng = np.random.default_rng(1)
    p = []
    for _ in range(RUNS):
        samples, spacing = independent_samples(gas(rng, own, shared))
        p.append(stats.kstest(samples, "norm").pvalue)
    assert stats.kstest(p, "uniform").pvalue > LEAST_P
    assert len(samples) >= INSTANTS * DISCS / 16 / spacing - DISCS


def test_samples_of_a_velocity_are_of_other_speeds():
    """A light disc among heavy ones keeps its speed for longer than its direction: without squares KS p is 2e-14."""
    rng = np.random.default_rng(4)
    p = []
    for _ in range(RUNS):
        speed = np.hypot(gas(rng, 0.95, 0.95), gas(rng, 0.95, 0.95))  # of a Maxwell-Boltzmann distribution
        angle = rng.uniform(0, 2 * np.pi, speed.shape)
        samples, _ = independent_samples((speed * np.cos(angle))[:, :1])
        p.append(stats.kstest(samples, "norm").pvalue)
    assert stats.kstest(p, "uniform").pvalue > LEAST_P


def test_what_is_conserved_sets_no_spacing():
    """Rounding of the mean of all discs, which is 0, is not a fluctuation."""
    rng = np.random.default_rng(2)
    values = rng.normal(size=(INSTANTS, DISCS))
    values -= values.mean(axis=1, keepdims=True)
    assert np.ptp(values.mean(axis=1)) > 0
    assert independent_samples(values)[1] <= 2


def test_only_more_than_the_error_of_a_law_is_rejected():
    """Rates 1 and 1 + ε differ by ε/e in the distribution function: 0.0074 for 0.02, and 0.035 for 0.1."""
    rng = np.random.default_rng(3)
    samples, counts = rng.exponential(size=50_000), np.ones((20, 4))

    def p_value(rate, error):
        law = {"exponential": WaitingTimeLaw(rate)}
        result = distribution_of("gas", np.arange(3.0), counts, Estimate(1, 0, 1), samples, None, law, error)
        return result.tests[0].p_value

    assert p_value(1.0, 0.0) > LEAST_P
    assert p_value(1.02, 0.01) > 0.5
    assert p_value(1.02, 0.0) < 0.05
    assert p_value(1.1, 0.01) < 1e-6
