"""Measure diffusion, viscosities and thermal conductivity, collision rates, free paths and the pair distribution.

The results are compared with Enskog theory and with the collision rates of kinetic theory. Viscosities and thermal
conductivity require a box whose sides are all periodic. Use `idealgas histogram --quantity free-path` for the
distribution of free paths. Several logs, or DIR, the folder of a sweep with the analysis "transport", give the ratios
of the coefficients to Enskog's values against the packing fraction.
"""

from collections.abc import Sequence

from idealgas.analysis.analysis import Analysis, Option, Section
from idealgas.analysis.transport.measure import transport
from idealgas.analysis.transport.result import Transport
from idealgas.analysis.transport.states import TransportStates, transport_states


class TransportAnalysis(Analysis):
    """Declaration of the analysis `transport`; users see the docstring of the function `transport`."""

    position = 70
    headline = "diffusion.*.coefficient"
    results = (Transport, TransportStates)
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

    @staticmethod
    def combine(results: Sequence[Transport]) -> Transport | TransportStates:
        """Return the coefficients of several runs in units of Enskog's; a single result is returned unchanged."""
        return results[0] if len(results) == 1 else transport_states(results)
