"""Hits of walls by discs that do not interact."""

import math

import pytest

from idealgas.physics.noninteracting import wall_hits_per_length

pytestmark = pytest.mark.interpreted


def test_the_mean_path_between_fixed_discs_and_walls():
    """π A/P, which is 0.6213 for two discs of radius 1 in the cell of `lorentz`; a wall counts with one face."""
    area = 2.25 * 2.25 * math.sqrt(3) - 2 * math.pi
    assert 1 / wall_hits_per_length([(0.0, 1.0)] * 2, area) == pytest.approx(area / 4, rel=1e-14)
    assert area / 4 == pytest.approx(0.6213, abs=5e-5)
    assert wall_hits_per_length([(3.0, 0.0), (1.0, 0.0)], 8.0) == pytest.approx(1 / (2 * math.pi), rel=1e-14)
    assert wall_hits_per_length([], 8.0) == 0.0
