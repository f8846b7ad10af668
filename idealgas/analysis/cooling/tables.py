"""Tables of the cooling of a gas."""

from idealgas.analysis.cooling.measure import Cooling
from idealgas.analysis.core.tables import Number, Table, estimates

ROWS = 9
"""Number of instants that are shown; CSV has all."""


def cooling_tables(result: Cooling) -> list[Table]:
    """Tables of what a uniform gas keeps while it cools, and its time series."""
    rows = [
        ("T lost per collision of a disc (share)", result.loss),
        ("Haff's time τ, T = T₀/(1 + t/τ)² (time)", result.haff),
        ("a₂ = ⟨v⁴⟩/2⟨v²⟩² - 1", result.fourth),
    ]
    if result.temperature_ratio is not None:
        rows.append(("temperature of spin over that of motion", result.temperature_ratio))
    rows += [
        ("scatter of numbers in cells, first tenth", result.first_scatter),
        ("scatter of numbers in cells, last tenth", result.last_scatter),
        ("square of momenta of cells over chance, last tenth", result.last_flow),
    ]
    window = f"window: t = {result.start:.6g} to {result.end:.6g}"
    cells = (
        f"{result.cells} cells; scatter of numbers: variance over mean; 1, as is the momenta's, for independent discs"
    )
    columns = {"collisions": result.collisions, "kinetic energy per disc": result.temperature}
    if result.law is not None:
        columns["law"] = result.law
    if result.spin is not None:
        columns["I ω² per disc"] = result.spin
    columns |= {"a₂": result.cumulant, "scatter": result.scatter, "flow": result.flow}
    values = zip(*(column.tolist() for column in (result.time, *columns.values())), strict=True)
    series = Table("Time series", ("t", *columns), [tuple(map(Number, row)) for row in values], most=ROWS)
    return [estimates("Cooling", rows, (window, cells)), series]
