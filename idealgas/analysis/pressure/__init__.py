"""Measure the pressure from the walls and from the virial, and compare Z = PA/NT with the ideal gas and hard discs.

Collision rates and mean free paths are measured from the same events. Several logs, or DIR, the folder of a sweep with
the analysis "pressure", give the equation of state: Z against the packing fraction, and its virial coefficients. Z is
not defined under gravity, with a piston or walls inside the box, with collisions that lose energy, or with several
temperatures. The result is then the mechanical pressure on every wall: the momentum that the discs transfer to the wall
per time and length.
"""

from collections.abc import Sequence

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.pressure.equation_of_state import EquationOfState, equation_of_state
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.pressure.result import Pressure


class PressureAnalysis(Analysis):
    """Declaration of the analysis `pressure`; users see the docstring of the function `pressure`."""

    position = 0
    headline = "routes.pairs_virial*.compressibility_factor"
    results = (Pressure, EquationOfState)
    sections = (
        Section("Pressure", "Z by every route with standard errors and theory, or else the pressure on every wall"),
    )
    averages = True

    measure = staticmethod(pressure)

    @staticmethod
    def combine(results: Sequence[Pressure]) -> Pressure | EquationOfState:
        """Return the equation of state of several runs; the result of a single run is returned unchanged."""
        return results[0] if len(results) == 1 else equation_of_state(results)
