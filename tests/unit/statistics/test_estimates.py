import math
import subprocess
import sys

import numpy as np
import pytest
from scipy import stats

from idealgas.statistics import estimates as statistics
from idealgas.statistics.estimates import Estimate, ks_p_value


def autoregressive(rng, length, memory, runs=1):
    """Stationary AR(1) series of mean 5 and variance 1, whose statistical inefficiency is (1 + a)/(1 - a)."""
    noise = rng.normal(size=(length, runs))
    series = np.empty_like(noise)
    series[0] = noise[0]
    for k in range(1, length):
        series[k] = memory * series[k - 1] + np.sqrt(1 - memory**2) * noise[k]
    return series + 5.0


def test_errors_by_blocks_of_a_straight_line():
    """0 to 15, of the variance 16 · 17/12, and means of pairs, of 4 · 8 · 9/12; over √16 and √8 of them, and 2."""
    result = statistics.errors_by_blocks(np.arange(16.0), 2.0)
    assert result == ((1 / 16, pytest.approx(math.sqrt(16 * 17 / 12) / 8)), (2 / 16, pytest.approx(math.sqrt(3) / 2)))


@pytest.mark.parametrize(
    ("samples", "distance"), [((0.5, 0.6), 0.5), ((0.4, 0.5), 0.5), ((0.7, 0.9), 0.7), ((0.1, 0.2), 0.8)]
)
def test_distances_from_an_even_distribution(samples, distance):
    assert statistics.ks_distance(np.array(samples), lambda x: x) == pytest.approx(distance)


def test_an_estimate_times_a_factor():
    assert Estimate(1.2, 0.1, 40).deviation is None
    assert Estimate(2.0, 0.1, 9.0, 3.0, 0.25).times(-2.0) == Estimate(-4.0, 0.2, 9.0, -6.0, 0.5)
    assert Estimate(2.0, 0.1, 9.0).times(3.0) == Estimate(6.0, pytest.approx(0.3), 9.0)
    assert Estimate(1.5, 0.3, 9.0, 1.0, 0.4).deviation == pytest.approx(1.0)  # 0.5/√(0.3² + 0.4²)
    assert Estimate(1.5, 0.3, 9.0, 1.0, 0.4).times(-2.0).deviation == pytest.approx(-1.0)


def test_an_estimate_comes_back_from_its_numbers_and_unknown_ones_are_null():
    known = Estimate(1.5, 0.03, 100.0, 1.4, 0.04)
    assert Estimate.from_dict(known.as_dict()) == known
    assert Estimate(math.nan, math.inf, 3.0).as_dict()["value"] is None


@pytest.mark.parametrize(
    ("samples", "level", "half"),
    [
        (2.0, 0.5, 1.0),  # Student's t with one degree of freedom is Cauchy's law: tan(π/4)
        (3.0, 0.95, 4.302652729911275),  # with two: level √(2/(1 - level²))
        (math.inf, 0.95, 1.959963984540054),
        (0.0, 0.5, 1.0),
    ],
)
def test_an_interval_has_one_degree_of_freedom_less_than_samples(samples, level, half):
    assert Estimate(5.0, 0.1, samples).interval(level) == pytest.approx((5 - 0.1 * half, 5 + 0.1 * half), rel=1e-11)


@pytest.mark.parametrize("n", [2, 3, 30])
def test_bootstrap_error_of_a_mean(n):
    """Of two values it would be √½ of the standard error without the factor √(n/(n - 1))."""
    values = np.random.default_rng(2).normal(size=n)
    result = statistics.bootstrap(values)
    assert result.value == values.mean()
    assert result.standard_error == pytest.approx(values.std(ddof=1) / np.sqrt(n), rel=0.06)  # 4/√(2·2000) resamples


def test_degrees_of_freedom_of_a_mean_of_runs():
    """Four runs of three samples have 4·2 of them; a run with all of the variance has its own two (Welch 1947)."""
    run = Estimate(1.0, 0.2, 3.0)
    assert statistics.mean_of_replicates([run] * 4) == Estimate(1.0, pytest.approx(0.1), pytest.approx(1 + 8))
    assert statistics.mean_of_replicates([run] * 3 + [Estimate(1.0, 1e6, 3.0)]).independent_samples == pytest.approx(3)


def test_constant_and_short_series():
    constant = statistics.mean(np.full(50, 2.5), theory=2.5)
    assert (constant.value, constant.standard_error, constant.deviation) == (2.5, 0.0, None)
    rounded = statistics.mean(2.5 + np.spacing(2.5) * np.random.default_rng(1).integers(0, 4000, 50), theory=2.5)
    assert (rounded.standard_error, rounded.deviation) == (0.0, None)
    assert np.isnan(statistics.mean(np.array([1.0])).standard_error)


def test_a_few_large_steps_of_a_store_say_little_of_its_change():
    rates = np.zeros(100)
    rates[[20, 50, 80]] = 1.0
    few = statistics.mean_of_flux(rates, np.zeros(100), stored=1e6)
    assert few.independent_samples == pytest.approx(1 + 2 * 3, rel=1e-4)
    assert few.standard_error == pytest.approx(math.sqrt(3) / 100, rel=1e-4)
    assert statistics.mean_of_flux(np.zeros(100), np.zeros(100), stored=1.0).standard_error == 0.0


def test_an_estimate_as_text_has_its_error_theory_and_deviation():
    assert str(Estimate(1.10919, 0.00077, 100.0)) == "1.1092(8)"
    assert str(Estimate(1.10919, 0.00077, 100.0, theory=1.109537)) == "1.1092(8), theory 1.10954, −0.5σ"
    assert str(Estimate(0.5, 0.0, math.inf, theory=0.5)) == "0.5, theory 0.5"


def test_few_events_have_no_error_and_no_more_samples_than_events():
    """Two lengths in 400 blocks are two samples: their scatter shows no error; nine show one with 8 degrees at most."""
    for number, known in ((2, False), (7, False), (8, True), (9, True)):
        events, lengths = np.zeros(400), np.zeros(400)
        events[:number], lengths[:number] = 1, 230 + np.arange(number)
        result = statistics.of_events(statistics.ratio(lengths, events), number)
        assert result.value == pytest.approx(lengths.sum() / number)
        assert bool(result.standard_error > 0) == known
        assert result.independent_samples <= number


@pytest.mark.parametrize(("samples", "off"), [(10, 0.0025), (50, 0.0003), (1000, 3e-5)])
def test_p_values_of_kolmogorov_and_smirnov(samples, off):
    """The exact distribution of SciPy: Simard & L'Ecuyer, J. Stat. Softw. 39, 11 (2011)."""
    distances = np.linspace(0.3, 2.5, 200) / math.sqrt(samples)
    exact = stats.kstwo.sf(distances, samples)
    assert np.abs(exact - [ks_p_value(distance, samples) for distance in distances]).max() < off


def test_common_fluctuations_cancel_in_a_ratio():
    a = autoregressive(np.random.default_rng(3), 500, 0.5)[:, 0]
    result = statistics.ratio(3 * a, a)
    assert result.value == pytest.approx(3.0, rel=1e-14)
    assert result.standard_error < 1e-8  # slopes are finite differences


def test_errors_by_blocks_rise_to_the_stated_one():
    """The mean of AR(1) with a = 0.9 has √((1 + a)/(1 - a)) = 4.4 times the error of independent samples."""
    n, a = 2**16, 0.9
    result = statistics.mean(autoregressive(np.random.default_rng(1), n, a)[:, 0])
    share, error = np.array(result.blocks).T
    assert share.tolist() == [2.0**k / n for k in range(14)]  # 8 blocks and more
    assert np.all(np.diff(error[:6]) > 0)
    error *= result.standard_error * math.sqrt(n)
    assert error[0] == pytest.approx(1, rel=0.05)
    long = (share * n > 10 / (1 - a)) & (share < 1 / 32)
    exact = math.sqrt((1 + a) / (1 - a))
    assert np.all(np.abs(error[long] / exact - 1) < 4 * np.sqrt(share[long] / 2) + 0.05)  # blocks are 5 % short
    assert result.times(-3.0).blocks == result.blocks
    assert statistics.mean(np.ones(64)).blocks == ()


@pytest.mark.parametrize(("memory", "length"), [(0.0, 100), (0.0, 512), (0.5, 512), (0.8, 1000), (0.9, 2000)])
def test_interval_covers_the_truth(memory, length):
    series = autoregressive(np.random.default_rng(7), length, memory, runs=200)
    intervals = [statistics.mean(series[:, k]).interval(0.95) for k in range(200)]
    assert 180 <= sum(low < 5.0 < high for low, high in intervals) <= 198


def test_interval_of_a_ratio_covers_the_truth():
    rng, hits = np.random.default_rng(11), 0
    for _ in range(200):
        below = autoregressive(rng, 400, 0.5)[:, 0]
        low, high = statistics.ratio(2 * below + rng.normal(size=400), below).interval()
        hits += low < 2.0 < high
    assert 180 <= hits <= 198


def rms(deviations):
    """Of 300 normal deviates it scatters by 1/√600."""
    assert len(deviations) == 300
    return np.sqrt(np.mean(np.square(deviations)))


@pytest.mark.parametrize("length", [100, 1000])
def test_flux_has_the_error_of_the_bulk_and_of_its_store(length):
    """A store that swings for longer than the series lasts, driven by nothing."""
    rng, deviations = np.random.default_rng(13), []
    for _ in range(300):
        bulk = rng.normal(size=length)
        store = 8 * np.sin(0.4 * np.arange(length + 1) + rng.uniform(0, 7)) + rng.normal(size=length + 1)
        deviations.append(statistics.mean_of_flux(bulk + np.diff(store), bulk, 0.0).deviation)
    assert abs(rms(deviations) - 1) < 4 / np.sqrt(600)


@pytest.mark.parametrize("length", [10, 30, 100, 1000])
def test_flux_has_the_error_of_a_store_of_known_variance(length):
    """A store of variance 9 that forgets its state in 50 samples: at first it wanders, later its change is bounded."""
    rng, deviations = np.random.default_rng(17), []
    for _ in range(300):
        store = 3 * (autoregressive(rng, length + 1, math.exp(-1 / 50))[:, 0] - 5)
        result = statistics.mean_of_flux(5 + np.diff(store), np.full(length, 5.0), 5.0, 9.0)
        assert result.value == pytest.approx(5 + (store[-1] - store[0]) / length)
        deviations.append(result.deviation)
    more = math.sqrt(length / (length - 2))  # at first the error is known as from as many squares as there are samples
    assert 1 - 4 / math.sqrt(600) < rms(deviations) < more * (1 + 4 / math.sqrt(600))


def test_flux_has_the_error_of_a_store_that_starts_from_rest():
    """The start need not be a state of chance: of a store that starts at its mean, only the end is uncertain."""
    rng, deviations = np.random.default_rng(19), []
    for _ in range(300):
        store = np.append(0.0, autoregressive(rng, 400, 0.5)[20:, 0] - 5)
        deviations.append(statistics.mean_of_flux(np.diff(store), np.zeros(len(store) - 1), 0.0).deviation)
    assert abs(rms(deviations) - 1) < 4 / np.sqrt(600)


def test_statistics_import_little_of_scipy():
    """The rest of it would be half of the time in which most analyses start."""
    code = (
        "import sys, idealgas.statistics.estimates, idealgas.tallies.equilibration, idealgas.tallies.equilibrium\n"
        "assert not {'scipy.stats', 'scipy.optimize'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_known_memory_makes_the_error_of_a_faint_slow_process_right():
    """A slow process beside fast noise: blocks of a quarter of its inefficiency show it, single samples less."""
    rng, deviations = np.random.default_rng(5), {0.0: [], 30.0: []}
    slow = autoregressive(rng, 600, 29 / 31, runs=200) - 5.0  # inefficiency 30
    for series in (slow + 2 * rng.normal(size=slow.shape)).T:
        for memory, result in deviations.items():
            estimate = statistics.mean(series, memory=memory)
            result.append(estimate.value / estimate.standard_error)
    rms = {memory: np.sqrt(np.mean(np.square(result))) for memory, result in deviations.items()}
    assert rms[30.0] < rms[0.0]
    assert rms[30.0] < 1.3
