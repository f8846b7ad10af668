"""Measure how a gas cools whose discs lose energy in collisions: Haff's law, a₂, spin and clusters.

Haff's time and the loss per collision with the Sonine correction, the fourth cumulant a₂ of the velocities, the
ratio of the temperatures of spin and motion of rough discs, and how much numbers of discs in small cells scatter,
which tells when clusters form.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.cooling.measure import Cooling, cooling
from idealgas.analysis.cooling.tables import cooling_tables
from idealgas.analysis.core.analysis import Analysis, Section

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class CoolingAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `cooling`."""

    position = 30
    results = (Cooling,)
    sections = (
        Section(
            "Cooling",
            "Temperature against time, then cumulant, temperature ratio of rough discs, and the scatter of numbers and "
            "momenta in cells against collisions of a disc; theory dashed",
        ),
    )
    start = "20 collisions per disc, or more with slow spins"
    reads = "frames"

    measure = staticmethod(cooling)
    tables = staticmethod(cooling_tables)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.cooling.figure import cooling_figure

        return cooling_figure(result)
