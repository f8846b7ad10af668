"""Tables of distributions: means and Kolmogorov-Smirnov tests."""

from idealgas.analysis.core.tables import Number, Table, describe, estimates
from idealgas.analysis.histogram.measure import Histogram


def histogram_tables(result: Histogram) -> list[Table]:
    """Tables of the means, and of the Kolmogorov-Smirnov distances between samples and laws."""
    tests = [
        (
            found.name,
            test.law_name,
            Number(test.distance, ".4f"),
            Number(test.p_value, ".3g"),
            Number(found.samples, "d"),
            Number(found.correlation_time, ".4g"),
        )
        for found in result.distributions
        for test in found.tests
    ]
    means = [(found.name, found.mean) for found in result.distributions]
    notes = (describe(result.window), *([f"No law here: {result.no_law}."] if result.no_law else []))
    average = estimates(f"Mean {result.quantity} ({result.unit})", means, notes)
    if not tests:
        return [average]
    heads = ("", "law", "distance", "p", "samples", "spacing (time)")
    return [average, Table("Kolmogorov-Smirnov tests (no unit)", heads, tests)]
