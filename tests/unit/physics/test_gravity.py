"""Gravity: its components, and the potential energy, which falls as a disc falls."""

import pytest

from idealgas.physics.gravity import Gravity, acceleration_along, potential_energy

pytestmark = pytest.mark.interpreted


def test_components_and_potential_energy():
    """-m g·r: 2 (0.5 · 3 - 1 · 4) = -5."""
    gravity = Gravity(0.5, -1.0)
    assert [acceleration_along(gravity, along_y) for along_y in (False, True)] == [0.5, -1.0]
    assert potential_energy(2.0, (3.0, 4.0), gravity) == 5.0
    assert potential_energy(2.0, (3.0, 3.0), gravity) == 3.0  # lower along the pull
    assert acceleration_along(None, True) == potential_energy(2.0, (3.0, 4.0), None) == 0.0
