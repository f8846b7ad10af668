"""Tables of distributions: means, Kolmogorov-Smirnov tests and, in CSV, the bins."""

import numpy as np

from idealgas.analysis.core.tables import Cell, Number, Table, bars, describe, estimates
from idealgas.analysis.histogram.measure import Distribution, Histogram


def histogram_tables(result: Histogram) -> list[Table]:
    """Tables of the means, of Kolmogorov-Smirnov distances between samples and laws, and of the densities in bins."""
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
    heads = ("", "law", "distance", "p", "samples", "spacing (time)")
    distances = Table("Kolmogorov-Smirnov tests (no unit)", heads, tests)
    rows = [row for found in result.distributions for row in _bins(found)]
    heads = ("", "from", "to", "value", "± s.e.", "theory")
    return [
        average,
        *[distances] * bool(tests),
        Table(f"Density of {result.quantity} (per {result.unit})", heads, rows, most=0),
    ]


def _bins(found: Distribution) -> list[tuple[Cell, ...]]:
    """Rows of the bins, with the first of the laws as theory, as its mean over a bin."""
    edges = found.edges
    expected = np.diff(found.tests[0].law.cdf(edges)) / np.diff(edges) if found.tests else None
    theory = [None] * len(found.density) if expected is None else expected.tolist()
    columns = (edges[:-1].tolist(), edges[1:].tolist(), found.density.tolist(), found.error.tolist(), theory)
    return [(found.name, *map(Number, row)) for row in zip(*columns, strict=True)]


LINES = 24
"""Number of lines of a histogram; bins are put together."""


def histogram_text(result: Histogram) -> str:
    """Histogram of each species in characters, with the first of its laws."""
    return "\n".join(_histogram(found, f"{result.quantity} ({result.unit})") for found in result.distributions)


def _histogram(found: Distribution, quantity: str) -> str:
    groups = np.array_split(np.arange(len(found.density)), LINES)
    widths = np.diff(found.edges)
    middle = (found.edges[1:] + found.edges[:-1]) / 2

    def together(density: np.ndarray) -> list[float]:
        return [float(np.average(density[group], weights=widths[group])) for group in groups]

    law = found.tests[0] if found.tests else None
    title = f"{found.name}: {quantity}" + (f"; │ {law.law_name}" if law else "")
    lows = [float(found.edges[group[0]]) for group in groups]
    return f"{title}\n{bars(lows, together(found.density), together(law.law.pdf(middle)) if law else None)}"
