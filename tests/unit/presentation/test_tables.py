"""Digits of tables: two of an error, and the number to match."""

import math

import numpy as np
import pytest

from idealgas.presentation.tables import estimates, format_estimate, time_series, with_error
from idealgas.statistics.estimates import Estimate


@pytest.mark.parametrize(
    ("value", "error", "shown"),
    [
        (1.898934, 0.00692, ("1.8989", "0.0069")),
        (3.17478, 0.4567, ("3.17", "0.46")),
        (0.99951, 0.00996, ("1.000", "0.010")),
        (123456.0, 460.0, ("123456", "460")),
        (-0.000123, 0.002, ("-0.0001", "0.0020")),
        (6.62607e-15, 3.1e-18, ("6.6261e-15", "3.1e-18")),
        (2.5e12, 3.1e10, ("2.500e+12", "3.1e+10")),
        (0.0, 3.1e-18, ("0.0e+00", "3.1e-18")),
        (1.5, 0.0, ("1.5", "0")),
        (1.23456789, math.nan, ("1.23457", "nan")),
    ],
)
def test_two_digits_of_the_error(value, error, shown):
    assert tuple(map(str, with_error(value, error))) == shown


def test_tables_and_sentences_have_the_same_digits():
    result = Estimate(1.898934, 0.00692, 16.0, theory=1.8978612, theory_error=0.00099)
    ((_, *cells),) = estimates("t", [("rate", result)]).shown
    assert cells == ["1.8989", "0.0069", "16", "1.89786", "0.00099", "+0.15"]
    assert format_estimate(result) == "1.899(7)"
    series = time_series("t", {"t": np.array([1.0]), "P": np.array([1.898934]), "± s.e.": np.array([0.00692])})
    assert series.shown == [["1", "1.8989", "0.0069"]]
