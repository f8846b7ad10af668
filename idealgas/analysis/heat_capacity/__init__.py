"""Measure the heat capacity by every route that the logs allow.

Logs at several temperatures give the slope dE/dT. One log gives E/T by the pressure on the walls of a closed box,
Var(E)/T² in a heat bath, and with spin, gravity or a piston the fluctuations of the kinetic energy. DIR is the
folder of a sweep with the analysis "heat-capacity".
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.analysis import Analysis, Section
from idealgas.analysis.heat_capacity.combine import HeatCapacity, combine_heat_capacity, restore_heat_capacity
from idealgas.analysis.heat_capacity.measure import Measured, heat_capacity
from idealgas.analysis.heat_capacity.tables import heat_capacity_tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class HeatCapacityAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `heat_capacity`."""

    position = 100
    results = (
        Measured,
        HeatCapacity,
    )
    sections = (Section("Heat capacity", "Heat capacity per disc by every route with its standard error, and theory"),)
    averages = True

    measure = staticmethod(heat_capacity)
    tables = staticmethod(heat_capacity_tables)
    combine = staticmethod(combine_heat_capacity)
    restore = staticmethod(restore_heat_capacity)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.heat_capacity.figure import heat_capacity_figure

        return heat_capacity_figure(result)
