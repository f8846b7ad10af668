"""Equation of state from the pressures of several logs or of the points of a sweep."""

from collections.abc import Sequence
from typing import Any

from idealgas.analysis.pressure.equation_of_state import EquationOfState, PressureSample, equation_of_state, sample_of
from idealgas.analysis.pressure.measure import Pressure
from idealgas.analysis.pressure.routes import PAIRS
from idealgas.errors import UserError
from idealgas.statistics.estimates import Estimate


def combine_pressure(results: Sequence[Pressure | PressureSample]) -> Pressure | EquationOfState:
    """Return the pressure of a single log, or the equation of state of several logs or points of a sweep.

    Raises:
        UserError: if one of several gases is a mixture.
    """
    if len(results) == 1 and isinstance(results[0], Pressure):
        return results[0]
    return equation_of_state([sample_of(result) if isinstance(result, Pressure) else result for result in results])


def restore_pressure(values: dict[str, Any], label: str) -> PressureSample:
    """Return the compressibility factor of the point of a sweep that is named `label`, from its stored values.

    Raises:
        UserError: if the gas has no equation of state.
    """
    if not values["routes"]:
        raise UserError(f"{label}: {values['no_theory']}")
    pairs = next(route["compressibility_factor"] for route in values["routes"] if route["route"] == PAIRS)
    return PressureSample(values["packing_fraction"], values["number"], Estimate.from_dict(pairs))
