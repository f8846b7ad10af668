"""The temperature in words."""

from idealgas.analysis.core.words import format_estimate
from idealgas.analysis.temperature.measure import Temperature


def temperature_summary(result: Temperature) -> list[str]:
    """Sentence on the temperature of all discs."""
    return [f"The temperature is {format_estimate(result.species[-1].both)}."]
