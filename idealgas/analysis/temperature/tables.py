"""Table of temperatures."""

from idealgas.analysis.core.tables import Table, describe, estimates
from idealgas.analysis.temperature.measure import Temperature


def temperature_tables(result: Temperature) -> list[Table]:
    """Table of the temperature of every degree of freedom of each species."""
    rows = [
        (f"{entry.species}: {direction}", estimate)
        for entry in result.species
        for direction, estimate in (("m vx²", entry.x), ("m vy²", entry.y), ("m v²/2", entry.both))
    ]
    return [estimates("Temperatures (energy, k_B = 1), theory E/N", rows, (describe(result.window),))]
