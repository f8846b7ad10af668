"""Histograms in characters, for terminals."""

import numpy as np

from idealgas.analysis.core.bars import bars
from idealgas.analysis.histogram.measure import Distribution, Histogram

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
