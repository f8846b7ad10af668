"""Measure diffusion, viscosities and thermal conductivity, collision rates, free paths and the pair distribution.

The results are compared with Enskog's theory and the rates of kinetic theory. Viscosities and thermal conductivity
require a box with periodic sides. `idealgas histogram --quantity free-path` measures the distribution of free paths.
Several logs, or DIR, the folder of a sweep with the analysis "transport", give the coefficients over Enskog's values
against the packing fraction.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.analysis import Analysis, Option, Section
from idealgas.analysis.transport.combine import States, TransportSample, combine_transport, restore_transport
from idealgas.analysis.transport.measure import Transport, transport
from idealgas.analysis.transport.tables import transport_summary, transport_tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class TransportAnalysis(Analysis):
    """Declaration of the analysis `transport`; users see the docstring of that function."""

    position = 70
    headline = "diffusion.*.coefficient"
    results = (Transport, States, TransportSample)
    sections = (
        Section(
            "Transport",
            "Velocity correlation, mean square displacement, pair distribution, and transport coefficients over time",
        ),
    )
    options = (
        Option(
            "lag",
            float,
            "Longest lag up to which discs and currents are followed, in mean free times.",
            default=20.0,
            positive=True,
            metavar="X",
        ),
    )
    averages = True

    measure = staticmethod(transport)
    tables = staticmethod(transport_tables)
    combine = staticmethod(combine_transport)
    restore = staticmethod(restore_transport)
    summary = staticmethod(transport_summary)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Draw the result; matplotlib is imported only here."""
        from idealgas.analysis.transport.figure import transport_figure

        return transport_figure(result)
