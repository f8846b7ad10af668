"""Fourier's law between two walls, with jumps."""

import pytest

from idealgas.analysis.profile.conduction import JUMP, conduct
from idealgas.analysis.theory.hard_discs import mean_free_path


def test_a_small_jump_is_the_gradient_times_so_many_mean_free_paths():
    found = conduct(1.0, 1.01, 1000.0, 1.0, 1.0)
    jump = JUMP * mean_free_path(1.0, 1.0, 0.0) * 0.01 / 1000
    assert found.low - 1.0 == pytest.approx(jump, rel=0.01)
    assert 1.01 - found.high == pytest.approx(jump, rel=0.01)


def test_the_other_way_round_it_is_the_same():
    there, back = conduct(1.0, 2.0, 20.0, 1.0, 0.1), conduct(2.0, 1.0, 20.0, 1.0, 0.1)
    assert (there.low, there.high, there.error) == pytest.approx((back.high, back.low, back.error))


@pytest.mark.parametrize(("low", "high"), [(1.0, 2.0), (1.0, 100.0), (100.0, 1.0), (1.0, 1.0001)])
def test_a_narrow_box_has_none(low, high):
    path = mean_free_path(0.1, 1.0, 0.0)
    assert conduct(low, high, 0.5 * path, 1.0, 0.1) is None
    wide = conduct(low, high, 100 * path, 1.0, 0.1)
    assert min(low, high) < min(wide.low, wide.high) < max(wide.low, wide.high) < max(low, high)
