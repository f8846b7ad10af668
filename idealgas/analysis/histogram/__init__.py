"""Measure the distribution of a quantity and test it against theory.

Velocities and energies are weighted with the time that discs spend at them. A waiting time is that between successive
events of the whole gas. The Kolmogorov-Smirnov tests use decorrelated samples.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.analysis import Analysis, Option, Section
from idealgas.analysis.histogram.measure import QUANTITIES, Histogram, histogram
from idealgas.analysis.histogram.tables import histogram_tables, histogram_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _section(title: str, quantity: str) -> Section:
    caption = f"Density of {title.lower()}: measured with its standard errors, and its laws as lines"
    return Section(title, caption, {"quantity": quantity})


class HistogramAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `histogram`."""

    position = 50
    results = (Histogram,)
    sections = (
        _section("Speeds", "speed"),
        _section("Velocities along x", "vx"),
        _section("Energies", "energy"),
        _section("Free paths", "free-path"),
        _section("Free times", "free-time"),
        _section("Waiting times between events", "waiting-time"),
    )
    options = (
        Option("quantity", str, "Quantity whose distribution is measured.", default="speed", choices=tuple(QUANTITIES)),
    )

    measure = staticmethod(histogram)
    tables = staticmethod(histogram_tables)
    text = staticmethod(histogram_text)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.histogram.figure import histogram_figure

        return histogram_figure(result)
