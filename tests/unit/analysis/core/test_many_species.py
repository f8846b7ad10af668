"""Gases of many species: memory grows with the number of species, not with its square."""

import numpy as np
import pytest

from idealgas.analysis.core.impacts import Impacts
from idealgas.state import Gas


@pytest.mark.parametrize(("species", "groups"), [(32, 32), (33, 1), (1000, 1)])
def test_many_species_are_counted_with_all_discs(species, groups):
    ones, at_rest = np.ones(species), np.zeros((species, 2))
    names = tuple(f"s{k}" for k in range(species))
    gas = Gas((99.0, 99.0), at_rest, at_rest, ones, ones, np.arange(species, dtype=np.uint16), names)
    tally = Impacts()
    tally.begin(gas, np.linspace(0.0, 1.0, 513))
    assert tally.collisions.shape == (512, species, groups)
    assert gas.partners == (names if groups > 1 else ("all",))
