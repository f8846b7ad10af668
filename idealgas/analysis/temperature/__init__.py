"""Measure the temperature of every degree of freedom and species; by equipartition all are E/N."""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.analysis import Analysis, Section
from idealgas.analysis.temperature.measure import Temperature, temperature
from idealgas.analysis.temperature.tables import temperature_tables
from idealgas.analysis.temperature.words import temperature_summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class TemperatureAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `temperature`."""

    position = 10
    results = (Temperature,)
    sections = (Section("Temperature", "Kinetic temperature of each species against time"),)

    measure = staticmethod(temperature)
    tables = staticmethod(temperature_tables)
    summary = staticmethod(temperature_summary)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.temperature.figure import temperature_figure

        return temperature_figure(result)
