"""Numbers of collisions of a disc in a dilute gas: against simulated discs and exact limits."""

import math

import numpy as np
import pytest
from scipy import integrate, stats

from idealgas.analysis.theory.collision_counts import CollisionCountLaw
from idealgas.analysis.theory.distributions import mean_relative_speed_at


def simulated(mass, other, time, number, seed):
    """Numbers of collisions of discs at unit rate, by collisions with thermal discs at even impact parameters."""
    rng = np.random.default_rng(seed)
    velocity = rng.normal(scale=math.sqrt(1 / mass), size=(number, 2))
    counts, left, fastest = np.zeros(number, int), np.full(number, time), 9.0
    mean = math.sqrt(math.pi / 2 * (1 / mass + 1 / other))
    while (left > 0).any():
        left -= rng.exponential(mean / fastest, number)
        partner = rng.normal(scale=math.sqrt(1 / other), size=(number, 2))
        relative = velocity - partner
        hit = (left > 0) & (rng.random(number) < np.hypot(*relative.T) / fastest)
        angle = 2 * np.arccos(rng.uniform(-1, 1, number))
        turned = (relative[:, 0] + 1j * relative[:, 1]) * np.exp(1j * angle)
        turned = np.column_stack((turned.real, turned.imag))
        after = (mass * velocity + other * partner + other * turned) / (mass + other)
        velocity = np.where(hit[:, None], after, velocity)
        counts += hit
    return counts


@pytest.mark.parametrize(("mass", "other"), [(1.0, 1.0), (1.0, 4.0), (3.0, 1.0)])
def test_against_simulated_discs(mass, other):
    """40 000 discs know the variance over the mean to 0.8 %; 4 standard errors, and P > 0.001 for χ² of all numbers."""
    law = CollisionCountLaw(mass, (other,), (1.0,), 5.0)
    counts = simulated(mass, other, 5.0, 40_000, 1)
    ratio = counts.var() / counts.mean()
    spread = math.sqrt((((counts - counts.mean()) ** 2).var()) / len(counts)) / counts.mean()
    assert abs(ratio - law.cumulants[0]) < 4 * spread
    assert abs(counts.mean() - 5) < 4 * counts.std() / 200
    most = 16
    seen = np.append(np.bincount(counts, minlength=most)[:most], (counts >= most).sum())
    expected = np.append(law.probabilities[:most], law.probabilities[most:].sum()) * len(counts)
    assert stats.chisquare(seen, expected).pvalue > 0.001


@pytest.mark.parametrize("time", [0.5, 3.0])
def test_no_collision_at_all(time):
    """⟨exp(-ν(v) t)⟩ over speeds of a mass 2 among masses 1 and 5, by quadrature; 1e-4 as the basis is finite."""
    law, rates = CollisionCountLaw(2.0, (1.0, 5.0), (0.4, 0.6), time), {1.0: 0.4, 5.0: 0.6}

    def survives(v):
        means = {other: math.sqrt(math.pi / 2 * (0.5 + 1 / other)) for other in rates}
        rate = sum(rates[other] * mean_relative_speed_at(v, 1.0, other) / means[other] for other in rates)
        return 2 * v * math.exp(-(v**2)) * math.exp(-rate * time)

    assert law.probabilities[0] == pytest.approx(integrate.quad(survives, 0, 8)[0], rel=1e-4)


def test_limits():
    """Heavy discs hardly move, and collide as in a Poisson process; so do all discs in a short time."""
    assert CollisionCountLaw(1e5, (1.0,), (1.0,), 10.0).cumulants == pytest.approx((1, 1), abs=1e-3)
    assert CollisionCountLaw(1.0, (1.0,), (1.0,), 1e-4).cumulants == pytest.approx((1, 1), abs=1e-4)
    law = CollisionCountLaw(1.0, (1.0,), (2.0,), 50.0)
    assert law.probabilities.sum() == pytest.approx(1, abs=1e-12)
    assert np.arange(len(law.probabilities)) @ law.probabilities == pytest.approx(law.mean, rel=1e-10)


def test_as_a_continuous_distribution():
    law = CollisionCountLaw(1.0, (1.0,), (1.0,), 4.0)
    assert law.pdf(np.array([-1.0, 2.4, 1.6, 1e6])) == pytest.approx([0, *law.probabilities[[2, 2]], 0])
    assert law.cdf(np.array([-0.5, 0.5, 1.0])) == pytest.approx(
        [0, law.probabilities[0], law.probabilities[0] + law.probabilities[1] / 2]
    )
