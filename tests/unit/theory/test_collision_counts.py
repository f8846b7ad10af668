"""Numbers of collisions of a disc in a dilute gas: against simulated discs and exact limits."""

import math

import numpy as np
import pytest
from scipy import integrate, stats

from idealgas.theory.collision_counts import CollisionCountLaw
from idealgas.theory.distributions import mean_relative_speed_at


def simulated(time, number, seed):
    """Numbers of collisions of discs at unit rate, by collisions with thermal discs at even impact parameters."""
    rng = np.random.default_rng(seed)
    velocity = rng.normal(size=(number, 2))
    counts, left, fastest = np.zeros(number, int), np.full(number, time), 9.0
    while (left > 0).any():
        left -= rng.exponential(math.sqrt(math.pi) / fastest, number)
        partner = rng.normal(size=(number, 2))
        relative = velocity - partner
        hit = (left > 0) & (rng.random(number) < np.hypot(*relative.T) / fastest)
        angle = 2 * np.arccos(rng.uniform(-1, 1, number))
        turned = (relative[:, 0] + 1j * relative[:, 1]) * np.exp(1j * angle)
        turned = np.column_stack((turned.real, turned.imag))
        velocity = np.where(hit[:, None], (velocity + partner + turned) / 2, velocity)
        counts += hit
    return counts


def test_against_simulated_discs():
    """40 000 discs know the variance over the mean to 0.8 %; 4 standard errors, and P > 0.001 for χ² of all numbers."""
    law = CollisionCountLaw(5.0)
    counts = simulated(5.0, 40_000, 1)
    ratio = counts.var() / counts.mean()
    spread = math.sqrt((((counts - counts.mean()) ** 2).var()) / len(counts)) / counts.mean()
    assert abs(ratio - law.cumulants[0]) < 4 * spread
    assert abs(counts.mean() - 5) < 4 * counts.std() / 200
    most = 16
    seen = np.append(np.bincount(counts, minlength=most)[:most], (counts >= most).sum())
    expected = np.append(law.probabilities[:most], law.probabilities[most:].sum()) * len(counts)
    assert stats.chisquare(seen, expected).pvalue > 0.001


@pytest.mark.parametrize("mean", [0.5, 3.0])
def test_no_collision_at_all(mean):
    """⟨exp(-ν(v) t)⟩ over speeds, by quadrature; 1e-4 as the basis is finite."""

    def survives(v):
        rate = mean_relative_speed_at(v, 1.0, 1.0) / math.sqrt(math.pi)
        return v * math.exp(-(v**2) / 2) * math.exp(-rate * mean)

    law = CollisionCountLaw(mean)
    assert law.probabilities[0] == pytest.approx(integrate.quad(survives, 0, 12)[0], rel=1e-4)


def test_limits():
    """In a short time collisions are a Poisson process."""
    assert CollisionCountLaw(1e-4).cumulants == pytest.approx((1, 1), abs=1e-4)
    law = CollisionCountLaw(100.0)
    assert law.probabilities.sum() == pytest.approx(1, abs=1e-12)
    assert np.arange(len(law.probabilities)) @ law.probabilities == pytest.approx(100, rel=1e-10)


def test_as_a_continuous_distribution():
    law = CollisionCountLaw(4.0)
    assert law.pdf(np.array([-1.0, 2.4, 1.6, 1e6])) == pytest.approx([0, *law.probabilities[[2, 2]], 0])
    none, result = law.probabilities[:2]
    assert law.cdf(np.array([-0.5, 0.5, 1.0])) == pytest.approx([0, none, none + result / 2])
