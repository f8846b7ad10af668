"""The temperature in words."""

from idealgas.analysis.core.words import in_words
from idealgas.analysis.temperature.measure import Temperature


def temperature_words(result: Temperature) -> list[str]:
    """Sentence on the temperature of all discs."""
    return [f"The temperature is {in_words(result.species[-1].both)}."]
