import math

import numpy as np
import pytest
from scipy import stats

from idealgas.statistics import autoregression


def series_of(coefficients, length, rng):
    """A stationary autoregressive series with noise of variance 1."""
    p, burn = len(coefficients), 400
    result = rng.normal(size=length + burn)
    for k in range(p, len(result)):
        result[k] += np.dot(coefficients, result[k - p : k][::-1])
    return result[burn:]


PROCESSES = {
    "independent": ([], 1.0),
    "correlated": ([0.8], 25.0),
    "anticorrelated": ([-0.6], 1 / 2.56),
    "sound": ([1.7, -0.9], 25.0),
    "to and fro": ([0.2, -0.9], 1 / 2.89),
}
"""Coefficients, and spectrum at frequency 0: the variance of the mean of n samples is that over n."""


@pytest.mark.parametrize("name", PROCESSES)
def test_error_of_long_series(name):
    coefficients, spectrum = PROCESSES[name]
    rng = np.random.default_rng(1)
    actual = [autoregression.error_of_mean(series_of(coefficients, 4000, rng)) for _ in range(10)]
    squares = np.array([spread.error**2 * 4000 for spread in actual])
    own = np.mean([2 / spread.samples for spread in actual]) ** 0.5
    assert abs(squares.mean() / spectrum - 1) < 4 * own / np.sqrt(10)  # four standard errors
    assert own < 0.4


@pytest.mark.parametrize(("length", "last"), [(40, None), (150, None), (250, 25)], ids=["40", "150", "a tenth of 250"])
@pytest.mark.parametrize("name", PROCESSES)
def test_intervals_of_short_series_hold(name, length, last):
    rng = np.random.default_rng(2)
    held = 0
    for _ in range(300):
        series = series_of(PROCESSES[name][0], length, rng)
        error, samples = autoregression.error_of_mean(series, last) if last else autoregression.error_of_mean(series)
        held += abs(series[-(last or length) :].mean()) < stats.t.ppf(0.975, samples - 1) * error
    assert 0.90 <= held / 300 <= 0.99  # 95 ± 4 standard errors of 1.26


def test_short_and_constant_series():
    """And one whose squares are zero in double precision, which has no error."""
    tiny = 1e-302 * np.random.default_rng(5).normal(size=300)
    assert autoregression.is_constant(tiny)
    assert math.isnan(autoregression.error_of_mean(tiny).error)
    assert autoregression.error_of_mean(np.full(300, 1e-302)) == (0.0, 300.0)
    assert math.isnan(autoregression.error_of_mean(np.array([1.0])).error)
    assert autoregression.error_of_mean(np.full(9, 3.7)) == (0.0, 9)
    assert autoregression.error_of_mean(np.array([1.0, 3.0])) == (pytest.approx(1.0), pytest.approx(2.0))
    assert autoregression.inefficiency(np.full(50, 2.5)) == 1.0
    assert autoregression.inefficiency(np.arange(3.0)) == 1.0
    frozen = np.tile(np.random.default_rng(7).normal(size=8), (40, 1))
    assert autoregression.inefficiency(frozen) == 40.0


def test_variance_of_mean_sums_all_covariances():
    covariance = np.array([2.0, 0.7, -0.3, 0.1])
    result = autoregression.variance_of_mean(covariance)
    for n in range(1, 5):
        matrix = covariance[np.abs(np.subtract.outer(np.arange(n), np.arange(n)))]
        assert result[n - 1] == pytest.approx(matrix.mean())


def test_covariances_follow_the_model():
    process = autoregression.process_of(series_of([0.5, 0.3], 500, np.random.default_rng(3)))
    model = process.models[-1]
    result, p = process.covariances_of_models(50)[-1], len(model.coefficients)
    for k in range(p + 1, 50):
        assert result[k] == pytest.approx(model.coefficients @ result[k - p : k][::-1])
    assert process.covariances_of_models(2)[-1] == pytest.approx(result[:2])


@pytest.mark.parametrize(("length", "members"), [(2, 1), (16, 1), (250, 1), (60, 7)])
@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_numpy_and_compiled_functions_have_the_same_numbers(monkeypatch, length, members, memory):
    random = np.random.default_rng(7)
    series = np.transpose([series_of([memory], length, random) for _ in range(members)])
    processes = []
    for compiled in (False, True):
        monkeypatch.setattr(autoregression, "_is_worth_loading", lambda compiled=compiled: compiled)
        process = autoregression.process_of(series - series.mean())
        numbers = [process.weights, process.covariances(length), *(np.hstack(model) for model in process.models)]
        processes.append(([number.tolist() for number in numbers], process.spread(), process.spread(1)))
    assert processes[0] == processes[1]


@pytest.mark.parametrize(("memory", "expected"), [(0.0, 1.0), (0.5, 3.0), (0.9, 19.0)])
def test_inefficiency_of_a_known_process(memory, expected):
    rng = np.random.default_rng(5)

    def error(samples):  # four standard errors: the model's a has √((1 - a²)/n), and dg/da = 2/(1 - a)²
        return 4 * np.sqrt((1 - memory**2) / samples) * 2 / (1 - memory) ** 2 + 8 * expected / samples

    result = autoregression.inefficiency(series_of([memory], 20_000, rng))
    assert result == pytest.approx(expected, abs=error(20_000))
    members = np.column_stack([series_of([memory], 400, rng) for _ in range(100)])
    many = autoregression.inefficiency(members)
    assert expected * (1 - expected / 400) - error(40_000) < many < expected + error(40_000)  # weights 1 - k/n


def test_inefficiency_counts_no_swing_back():
    """Samples that swing are as far from independent as their first swing; anticorrelated ones are no less than 1."""
    rng = np.random.default_rng(6)
    phases = rng.uniform(0, 2 * np.pi, 30)
    swings = np.cos(0.4 * np.arange(300)[:, None] + phases)
    first = 1 + 2 * np.cos(0.4 * np.arange(1, 4)).sum()
    assert autoregression.inefficiency(swings) == pytest.approx(first, rel=0.05)
    assert autoregression.inefficiency(series_of([-0.6], 500, rng)) == 1.0


@pytest.mark.parametrize("scale", [1e-120, 1e176, 1e300])
def test_errors_of_series_of_any_size(scale):
    """Squares of a series of squared energies of 1e88 overflow in its own unit."""
    series = np.random.default_rng(5).normal(3, 1, 400)
    scaled, plain = (autoregression.error_of_mean(values) for values in (series * scale, series))
    assert scaled.error / scale == pytest.approx(plain.error, rel=1e-10)
    assert scaled.samples == pytest.approx(plain.samples, rel=1e-10)
    assert autoregression.inefficiency(series * scale) == pytest.approx(autoregression.inefficiency(series), rel=1e-10)


@pytest.mark.parametrize(("n", "memory"), [(1001, 0.0), (101, 12.0)])
def test_a_change_in_the_samples_that_fill_no_block_is_not_lost(n, memory):
    """Blocks of 3 samples leave out the first two; the mean is 1/n, and its error that of a single event, 1/n."""
    series = np.zeros(n)
    series[1] = 1.0
    error, _ = autoregression.error_of_mean(series, memory=memory)
    assert error == pytest.approx(1 / n, rel=0.05)
