"""How far rounding may take a result from the exact one, which tests work out with 50 digits."""

from types import SimpleNamespace

import mpmath
import numpy as np

U = 2.0**-53
"""Largest relative error of one rounding."""


def gamma(roundings: int) -> float:
    """Largest relative error of a product of so many factors 1 + δ, |δ| <= U, or of their inverses.

    Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed. (2002), lemma 3.1.
    """
    return roundings * U / (1 - roundings * U)


def exact(value) -> mpmath.mpf:
    """A float with all the digits of the surrounding `mpmath.workdps`."""
    return mpmath.mpf(float(value))


def body(**fields: float) -> SimpleNamespace:
    """A record of float64 fields that laws change as they do a disc's; t = 0 unless given."""
    return SimpleNamespace(**{name: np.float64(value) for name, value in ({"t": 0.0} | fields).items()})


def copy_of(record: SimpleNamespace) -> SimpleNamespace:
    """One that can change without changing the original."""
    return SimpleNamespace(**vars(record))
