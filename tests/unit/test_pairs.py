import numpy as np
import pytest

from idealgas.pairs import near_pairs


@pytest.mark.interpreted
@pytest.mark.parametrize("period", [(0.0, 0.0), (4.0, 0.0), (0.0, 3.0), (4.0, 3.0)])
@pytest.mark.parametrize("radii", [[0.05], [0.05, 0.9], [0.01, 0.02, 0.04, 0.3, 1.0]])
def test_every_pair_in_contact_is_near_and_no_pair_is_listed_twice(period, radii):
    """Against all pairs, with discs on the sides and on one another; of the pairs that are apart, few are near."""
    draw = np.random.default_rng(4)
    position = draw.random((300, 2)) * (4, 3)
    position[:4] = [0, 0], [4, 3], [0, 3], [4, 0]
    position[10] = position[11]
    radius = draw.choice(radii, 300)
    first, second = np.triu_indices(300, 1)
    apart = position[first] - position[second]
    length = np.array(period)
    apart -= np.where(length > 0, length * np.round(apart / np.where(length > 0, length, 1)), 0)
    touch = np.hypot(*apart.T) <= radius[first] + radius[second]
    near = [tuple(sorted(pair)) for i, k in near_pairs(position, radius, period) for pair in zip(i, k, strict=True)]
    assert len(set(near)) == len(near)
    assert set(zip(first[touch], second[touch], strict=True)) <= set(near)
    if len(radii) == 1:
        assert len(near) == touch.sum()


def test_no_discs_have_no_pairs():
    assert not list(near_pairs(np.empty((0, 2)), np.empty(0)))
