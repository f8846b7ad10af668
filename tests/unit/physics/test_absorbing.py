"""Discs that have left the gas: no position, no motion, no mass."""

import math

import numpy as np
import pytest
from helpers.rounding import body

from idealgas.physics.absorbing import has_left, inside, leave_gas, mass_in_gas
from idealgas.physics.rotation import Rotation

pytestmark = pytest.mark.interpreted

HOLES = np.array([True])


def test_a_disc_that_leaves_and_which_discs_are_inside():
    disc, spins = body(x=1.0, y=2.0, vx=3.0, vy=4.0, m=5.0), Rotation(np.array([6.0, 7.0]), np.ones(2), 0.0, 0.0)
    assert (has_left(disc, HOLES), mass_in_gas(disc, HOLES)) == (False, 5.0)
    leave_gas(disc, 1, spins)
    assert math.isnan(disc.x)
    assert math.isnan(disc.y)
    assert (disc.vx, disc.vy, spins.omega.tolist()) == (0.0, 0.0, [6.0, 0.0])
    assert (has_left(disc, HOLES), mass_in_gas(disc, HOLES)) == (True, 0.0)
    assert not has_left(disc, None)
    x = np.array([1.0, math.nan, 0.0])
    assert inside(x, HOLES).tolist() == [True, False, True]
    assert x[inside(x, None)].size == 3
