"""The pressure in words."""

from idealgas.analysis.core.words import format_estimate
from idealgas.analysis.pressure.measure import PAIRS, Pressure


def pressure_summary(result: Pressure) -> list[str]:
    """Sentence on Z, or on the pressure of every wall that stands beside an outer pressure, else of the first wall."""
    if result.mechanical is None:
        (z,) = (route.compressibility_factor for route in result.routes if route.name == PAIRS)
        return [f"Z = PA/NT is {format_estimate(z)} (1 for an ideal gas)."]
    walls = result.mechanical.walls
    shown = [wall for wall in walls if wall.pressure.theory is not None] or walls[:1]
    return [f"The pressure on the {wall.name} is {format_estimate(wall.pressure)}." for wall in shown]
