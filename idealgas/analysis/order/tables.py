"""Tables of the order of discs."""

from idealgas.analysis.core.tables import Number, Table, describe, estimates
from idealgas.analysis.order.measure import Order

MOST_ROWS = 12
"""Rows of a function of distance or wave number that are shown; CSV has all of them."""


def order_tables(result: Order) -> list[Table]:
    """Tables of hexagonal order, its correlation, and the structure factor of a periodic box."""
    rows = [
        ("|ψ₆| of a disc, mean", result.local),
        ("|Ψ₆|, of all discs together", result.whole),
        ("N |Ψ₆|²", result.square),
        ("share of discs with six neighbours", result.hexagons),
    ]
    notes = [f"{describe(result.window)}, {result.frames} frames"]
    found = result.structure
    if found is not None:
        rows.append(("S/N at the highest peak (positional order, squared)", found.positional))
        notes.append(f"highest peak of S at k = ({found.peak[0]:.5g}, {found.peak[1]:.5g})")
    else:
        notes.append("S(k) and positional order: in a periodic box only")
    if result.compressibility is not None:
        notes.append(f"S(k) at small k by theory: {result.compressibility:.4g} (nT times the compressibility)")
    correlation = result.distance, result.correlation, result.correlation_error
    tables = [
        estimates("Order (no unit)", rows, notes),
        _function("Correlation g₆ of ψ₆ (no unit)", "r (length)", *correlation),
    ]
    if found is not None:
        tables.append(
            _function("Structure factor, all directions (no unit)", "k (1/length)", found.k, found.value, found.error)
        )
    return tables


def _function(title: str, of: str, *columns) -> Table:  # type: ignore[no-untyped-def]
    rows = [
        (Number(float(x), ".4g"), Number(float(y), ".5g"), Number(float(error), ".2g"))
        for x, y, error in zip(*columns, strict=True)
    ]
    return Table(title, (of, "value", "± s.e."), rows, most=MOST_ROWS)
