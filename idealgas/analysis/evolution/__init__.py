"""Follow temperature, pressure, discs beyond a gate, piston and energies in time, with the temperature's law.

Laws: Haff's law for a cooling gas, the adiabat of a slow piston, the rest position of a piston under pressure, and
equilibrium for isolated gases, gases under gravity and heat baths. The pressure is the mechanical one on the walls.
With a piston the picture has the pressure against the area, with the isotherm and the adiabat through the start.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.analysis import Analysis, Section
from idealgas.analysis.evolution.measure import Evolution, evolution
from idealgas.analysis.evolution.tables import evolution_summary, evolution_tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class EvolutionAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `evolution`."""

    position = 20
    results = (Evolution,)
    sections = (
        Section(
            "Evolution",
            "Temperature in time with its law dashed, then the gate, the pressure, the piston and the walls",
        ),
    )
    start = "the log's start"
    reads = "frames"

    measure = staticmethod(evolution)
    tables = staticmethod(evolution_tables)
    summary = staticmethod(evolution_summary)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.evolution.figure import evolution_figure

        return evolution_figure(result)
