"""Error bars of the pressure in bins of time, where the gas changes and where it is calm."""

import math

import numpy as np
import pytest
from helpers.logs import gas

from idealgas.analysis.evolution.pressure_series import GROUP, pressure_series
from idealgas.analysis.evolution.pressure_series import _scatter as scatter

BINS = 64
GAS = gas(
    200, 0.05, (10.0, 10.0), "until = 100", temperature=30.0, then="thermostat = { temperature = 1.0, rate = 0.3 }"
)


def scatters(change, spread=1.0):
    """Mean and standard error over 200 series of bins whose errors are 1, with a change in the series."""
    actual = [
        scatter(spread * draw.normal(size=BINS) + change, np.ones(BINS))
        for draw in map(np.random.default_rng, range(200))
    ]
    return np.mean(actual), np.std(actual) / math.sqrt(len(actual))


@pytest.mark.parametrize("spread", [0.5, 1.0, 2.0])
def test_the_scatter_of_calm_bins(spread):
    """Within 3 %: the groups overlap, and those far beyond the median are left out."""
    mean, error = scatters(np.linspace(0.0, 40.0, BINS), spread)
    assert mean == pytest.approx(spread, rel=0.03)
    assert error < 0.02 * spread


@pytest.mark.parametrize(("begin", "end"), [(0, 4), (60, 64), (30, 31)])
def test_a_change_in_some_bins_is_no_scatter_of_the_others(begin, end):
    """A jump of 100 errors is in at most 19 of 49 groups, which do not count."""
    change = np.zeros(BINS)
    change[begin:end] = 100.0
    assert scatters(change)[0] == pytest.approx(1.0, abs=0.06)


def test_bins_without_hits_leave_the_others_their_scatter():
    values, errors = 2.0 * np.random.default_rng(1).normal(size=BINS), np.ones(BINS)
    errors[:5] = np.nan
    assert 1.3 < scatter(values, errors) < 2.7
    assert scatter(values, np.full(BINS, np.nan)) == 1.0
    assert scatter(values[: GROUP - 1], errors[: GROUP - 1]) == 1.0


def test_errors_of_calm_times_are_the_same_without_the_change_before(make):
    """A bath cools the gas to a thirtieth within 5 of 100: where that counted, errors were 3 to 6 times as large."""
    ratios = []
    for seed in (1, 2, 3, 4):
        log = make(f"scene.seed={seed}")
        whole, late = pressure_series(log, 0.0, 100.0), pressure_series(log, 50.0, 100.0)
        for wall in ("left wall", "all sides"):
            of_whole = np.sqrt((whole.error[wall][whole.edges[1:] > 50.0] ** 2).mean() * np.diff(whole.edges)[0])
            of_late = np.sqrt((late.error[wall] ** 2).mean() * np.diff(late.edges)[0])
            ratios.append(of_whole / of_late)
    assert 0.6 < np.mean(ratios) < 1.6
