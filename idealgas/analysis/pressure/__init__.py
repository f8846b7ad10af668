"""Measure the pressure by walls and virial, and compare Z = PA/NT with the ideal gas and hard discs.

Collision rates and mean free paths come from the same events. Several logs, or DIR, the folder of a sweep with the
analysis "pressure", give the equation of state: Z against the packing fraction, and its virial coefficients. Z is not
defined under gravity, with a piston or walls inside the box, with collisions that lose energy or with several
temperatures. The result is then the mechanical pressure on every wall, that is, the momentum that the discs give to it
per time and length.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.pressure.combine import combine_pressure, restore_pressure
from idealgas.analysis.pressure.equation_of_state import EquationOfState, PressureSample
from idealgas.analysis.pressure.measure import Pressure, pressure
from idealgas.analysis.pressure.tables import pressure_summary, pressure_tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class PressureAnalysis(Analysis):
    """Declaration of the analysis `pressure`; users see the docstring of that function."""

    position = 0
    headline = "routes.pairs_virial*.compressibility_factor"
    results = (Pressure, EquationOfState, PressureSample)
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
        """Draw the result; matplotlib is imported only here."""
        from idealgas.analysis.pressure.figure import pressure_figure

        return pressure_figure(result)
