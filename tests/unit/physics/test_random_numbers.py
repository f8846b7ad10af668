"""SplitMix64 beside its published numbers."""

import numpy as np
import pytest

from idealgas.physics.random_numbers import GOLDEN, disc_uniform, mix, unit_interval

pytestmark = pytest.mark.interpreted


def test_splitmix64_gives_its_published_numbers_and_the_interval_excludes_zero():
    """For seed 1234567, as printed with the reference implementation (Vigna, https://prng.di.unimi.it/splitmix64.c)."""
    expected = [6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431]
    with np.errstate(over="ignore"):
        actual = [int(mix(np.uint64(1234567) + np.uint64(k) * GOLDEN)) for k in range(1, 5)]
    assert actual == expected
    assert unit_interval(np.uint64(0)) == 2.0**-53
    assert unit_interval(np.uint64(2**64 - 1)) == 1.0


def test_each_disc_has_eight_numbers_of_its_own_for_each_event():
    with np.errstate(over="ignore"):
        drawn = {
            disc_uniform(np.uint64(5), disc, np.uint64(event), draw)
            for disc in range(3)
            for event in range(3)
            for draw in range(8)
        }
    assert len(drawn) == 72
