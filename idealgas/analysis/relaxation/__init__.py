"""Measure the relaxation of the velocities to Maxwell-Boltzmann's distribution.

The relaxation time is that of an exponential fitted to the kurtosis of the velocities; its error is that
of the fluctuations of a gas of so many discs. Several logs are drawn in one picture.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.analysis import Analysis, Option, Section
from idealgas.analysis.relaxation.measure import Relaxation, Relaxations, combine_relaxation, relaxation
from idealgas.analysis.relaxation.tables import relaxation_tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class RelaxationAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `relaxation`."""

    position = 60
    results = (
        Relaxation,
        Relaxations,
    )
    sections = (
        Section(
            "Relaxation",
            "Kurtosis of the velocity, Kolmogorov-Smirnov distance and Boltzmann's H on the way to equilibrium",
        ),
    )
    options = (
        Option(
            "every",
            float,
            "Also show the speed distribution every X trials (Monte Carlo) or X units of time (other runs).",
            positive=True,
            metavar="X",
        ),
    )
    start = "the log's start"
    end = "after 40 collisions per disc"
    reads = "instants"

    measure = staticmethod(relaxation)
    tables = staticmethod(relaxation_tables)
    combine = staticmethod(combine_relaxation)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.relaxation.figure import relaxation_figure

        return relaxation_figure(result)
