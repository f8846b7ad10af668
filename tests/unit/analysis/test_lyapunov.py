"""Lyapunov exponents: what a whole spectrum has to fulfil, published entropies, and growth in a second run."""

import math

import numpy as np
import pytest
from helpers.logs import PERIODIC, gas, log_of

import idealgas
from idealgas import open_log, simulate
from idealgas.columns import SIDES


def log_of_discs(number, side, collisions, *overrides):
    return log_of(gas(number, 0.5, (side, side), f"collisions_per_disc = {collisions}", seed=1), *overrides)


@pytest.mark.parametrize(
    ("overrides", "zeros"),
    [(PERIODIC, 6), (PERIODIC[:2], 4), ((), 2), (("gravity.acceleration=[0, -0.5]",), 2)],
    ids=["periodic", "channel", "walls", "gravity"],
)
def test_pairs_and_zeros(overrides, zeros):
    """Conservative motion has pairs λ, -λ; of the whole spectrum as many are 0 as conservation laws ask for.

    Zeros fall with time: a deviation in them grows like t, so the bound is 3 ln(t)/t.
    """
    log = log_of_discs(6, 6.0, 400, *overrides)
    result = idealgas.lyapunov(log, start=0.0, exponents=24)
    values = np.array([each.value for each in result.exponents])
    assert result.zeros == zeros
    assert 1 / 6 < result.localisation.value < 1
    assert result.mean_free_time == pytest.approx(log.end_time / 400, rel=0.1)
    assert math.exp(result.lifetime(7) * values[0]) == pytest.approx(1e7)
    assert result.pairing < 1e-6 * values[0]
    assert result.largest_zero < 3 * math.log(log.end_time) / log.end_time
    assert values[12 - zeros // 2 - 1] > 5 * result.largest_zero
    assert (np.diff(values) < 0.02 * values[0]).all()
    each = idealgas.lyapunov(log, start=0.0)
    assert abs(each.exponents[0].value - values[0]) < 4 * result.exponents[0].standard_error
    assert result.entropy.value == pytest.approx(values[values > 0].sum(), rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("density", [0.01, 0.001])
def test_entropy_of_dilute_gases(density):
    """h/N = 0.499(1) ν (-ln nσ² + 1.366(5)): van Beijeren et al., Phys. Rev. E 56, 5272 (1997); k = 4."""
    log = log_of_discs(64, math.sqrt(64 / density), 500, *PERIODIC)
    result = idealgas.lyapunov(log, start=0.0, exponents=256)
    per_collision = result.mean_free_time / 64
    published = 0.499 * (-math.log(density) + 1.366)
    assert abs(result.entropy.value * per_collision - published) < 4 * result.entropy.standard_error * per_collision


def test_two_runs_separate_at_this_rate(tmp_path):
    """Runs that start 1e-9 apart are e^(λt) times as far apart later: rates of ten pairs, k = 4."""
    log, sides = log_of_discs(30, 9.0, 400, *PERIODIC), dict.fromkeys(SIDES, "periodic")
    result = idealgas.lyapunov(log, start=0.0).exponents[0]
    half, rates = 3 * math.log(10) / result.value, []
    for begin in np.linspace(20.0, log.end_time - 1.0, 10):
        state, ends = log.state_at(begin), []
        for shift in (0.0, 1e-9):
            position = (state.position + [shift, 0.0] * (np.arange(30) == 0)[:, None]) % 9.0
            discs = {"position": position, "velocity": state.velocity, "radius": 0.5, "mass": 1.0}
            scene = idealgas.Scene(box={"size": [9.0, 9.0], **sides}, discs=discs, run={"until": 2 * half})
            simulate(scene, tmp_path / "pair.h5", force=True)
            with open_log(tmp_path / "pair.h5") as pair:
                ends.append([np.hstack([each.position, each.velocity]) for each in pair.frames([half, 2 * half])])
        apart = np.abs(np.subtract(*ends))
        apart[..., :2] = np.minimum(apart[..., :2], 9.0 - apart[..., :2])
        rates.append(math.log(np.linalg.norm(apart[1]) / np.linalg.norm(apart[0])) / half)
    error = math.hypot(np.std(rates, ddof=1) / math.sqrt(10), result.standard_error)
    assert abs(np.mean(rates) - result.value) < 4 * error
    assert error < 0.2 * result.value
