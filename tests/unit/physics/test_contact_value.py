"""Henderson's contact value beside fractions."""

from fractions import Fraction

import numpy as np
import pytest
from rounding import gamma

from idealgas.physics.contact_value import contact_value

pytestmark = pytest.mark.interpreted


def test_contact_value():
    """8 roundings: two above, where the product's count less, three doubled by the square below, a quotient."""
    for phi in np.linspace(0, 0.9, 91).tolist():
        exact = (1 - Fraction(7, 16) * Fraction(phi)) / (1 - Fraction(phi)) ** 2
        assert abs(Fraction(contact_value(phi)) - exact) <= gamma(8) * exact


def test_a_dilute_gas_has_none_and_arrays_are_taken():
    assert contact_value(0.0) == 1.0
    phi = np.array([0.0, 0.1, 0.5])
    assert contact_value(phi) == pytest.approx([contact_value(p) for p in phi.tolist()], rel=gamma(4))
