"""Measure the pressure from the walls and from the virial, and compare Z = PA/NT with 1 and with hard discs.

Collision rates and mean free paths come from the same events. Several logs, or the folder of a sweep with the
analysis "pressure", give the equation of state: Z against the packing fraction, and the virial coefficients in it.
Under gravity, with a piston or walls inside, losses or heat of several temperatures there is no such Z: it is then
the mechanical pressure of every wall, the momentum that discs give to it per time and length.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.analysis import Analysis, Section
from idealgas.analysis.pressure.combine import combine_pressure, restore_pressure
from idealgas.analysis.pressure.equation_of_state import EquationOfState, Sample
from idealgas.analysis.pressure.measure import Pressure, pressure
from idealgas.analysis.pressure.tables import pressure_summary, pressure_tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class PressureAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `pressure`."""

    position = 0
    headline = "routes.pairs_virial*.compressibility_factor"
    results = (Pressure, EquationOfState, Sample)
    sections = (
        Section(
            "Pressure", "Z by every route with standard errors, theory as lines; without one the pressure of walls"
        ),
    )
    averages = True

    measure = staticmethod(pressure)
    tables = staticmethod(pressure_tables)
    combine = staticmethod(combine_pressure)
    restore = staticmethod(restore_pressure)
    summary = staticmethod(pressure_summary)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.pressure.figure import pressure_figure

        return pressure_figure(result)
