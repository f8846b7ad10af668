"""P-values of right laws are uniform, and bars of bins as large as deviations: `tools.p_values` has the gases.

`tests/tools/p_values.csv` is from 200 other seeds:

    PYTHONPATH=tests python -m tools.p_values --first 1000 --seeds 200
"""

import math

import numpy as np
import pytest
from helpers.logs import log_of
from scipy import stats
from tools.p_values import GASES, RUN, rows_of

from idealgas import histogram

LEAST_KS_P = 0.01
SEEDS = 12


@pytest.mark.long
@pytest.mark.parametrize("gas", GASES)
def test_p_values_are_uniform(gas):
    """Of 400 runs each; the share below 0.05 scatters by √(0.05·0.95/400) = 1.1 %."""
    for *name, runs, _, low, ks_p in rows_of(gas, range(400)):
        print(*name, low, ks_p)
        assert ks_p > LEAST_KS_P, name
        assert low < 0.05 + 4 * math.sqrt(0.05 * 0.95 / runs), name


@pytest.mark.parametrize("quantity", ["speed", "vx", "energy"])
def test_bars_of_bins(quantity):
    """Deviations of some 1000 bins in their bars: the rms is 1 within 10 %, and 95 % hold.

    A disc keeps its speed for some three mean free times, longer than a block.
    """
    deviations = []
    for seed in range(SEEDS):
        (result,) = histogram(log_of(f"[scene]\nseed = {seed}\n{GASES['closed']}{RUN}"), quantity).distributions
        law = np.diff(result.tests[-1].law.cdf(result.edges)) / np.diff(result.edges)
        known = result.error > 0
        assert known.sum() > 40
        deviations.append((result.density - law)[known] / result.error[known])
    z = np.concatenate(deviations)
    print(quantity, len(z), np.sqrt((z**2).mean()), (np.abs(z) < 1.96).mean())
    assert 0.9 < np.sqrt((z**2).mean()) < 1.1
    assert 0.93 < (np.abs(z) < 1.96).mean() < 0.97


@pytest.mark.parametrize("quantity", ["free-path", "free-time"])
def test_error_of_the_law_of_free_flights(quantity):
    """10⁴ free flights of 64 discs: at most 3 of 12 runs have p < 0.05, chance exceeds it in 0.2 %; else 7 and 8."""
    p, without = [], 0
    for seed in range(SEEDS):
        gas = GASES["periodic"].replace("count = 40", "count = 64").replace("radius = 0.04", "radius = 0.0315")
        (result,) = histogram(log_of(f"[scene]\nseed = {seed}\n{gas}{RUN}"), quantity).distributions
        assert result.samples > 8_000
        p.append(result.tests[0].p_value)
        without += stats.kstwo.sf(result.tests[0].distance, result.samples) < 0.05
    print(quantity, without, np.sort(p))
    assert sum(value < 0.05 for value in p) <= 3
