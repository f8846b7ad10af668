"""Tables of results, with the same rows for the terminal, notebooks and the report page; histograms in characters."""

import html
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from idealgas.errors import plain
from idealgas.statistics.rounding import with_last_digits

if TYPE_CHECKING:
    import numpy as np

    from idealgas.statistics.estimates import Estimate


class Number(NamedTuple):
    """A number in a table.

    Attributes:
        value: the number; None if there is none.
        digits: format of the number.
        absent: text that is shown if there is no value.
        instead: text that is shown in place of the value.
    """

    value: float | None
    digits: str = ".6g"
    absent: str = ""
    instead: str | None = None

    def __str__(self) -> str:
        if self.instead is not None:
            return self.instead
        return self.absent if self.value is None else f"{self.value:{self.digits}}"


Cell = str | Number


@dataclass(frozen=True)
class Table:
    """A table in a result.

    Attributes:
        title: title of the table.
        heads: headings of the columns; the first column names the rows.
        rows: cells, row by row.
        notes: lines that are printed before the rows.
        most: largest number of rows that are shown, chosen at even spacing from all rows; None for all rows.
        estimates: estimates in the rows, if the rows are estimates.
    """

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    notes: Sequence[str] = ()
    most: int | None = None
    estimates: Sequence["Estimate"] = ()

    @property
    def shown(self) -> list[list[str]]:
        """Text of the cells in the rows that are shown on the terminal and in the report."""
        rows, last = self.rows, len(self.rows) - 1
        if self.most is not None and last >= self.most:
            rows = [rows[round(last * k / (self.most - 1))] for k in range(self.most)]
        return [[str(cell) for cell in row] for row in rows]


ESTIMATE_HEADS = ("", "value", "± s.e.", "samples", "theory", "deviation (σ)")

MOST_DIGITS = 9
"""Largest number of digits on either side of the decimal point."""

SHOWN_ROWS = 9
"""Number of instants in a time series that the terminal and the report show."""

THEORY_ERROR = "± theory"
"""Heading of the column with the error of the theoretical value, in tables where theory has an error."""


def digits(error: float, *shown: float | None) -> str:
    """Return the format of numbers in which `error` has two digits and the numbers `shown` have as many decimals.

    Powers of ten are used if there would be too many decimals, and beyond MOST_DIGITS. Without an error there are six
    digits.
    """
    if not (math.isfinite(error) and error > 0):
        return ".6g"
    decimals = 1 - int(f"{error:.1e}".partition("e")[2])
    largest = max([error, *(abs(number) for number in shown if number is not None and math.isfinite(number))])
    if decimals <= MOST_DIGITS and largest < 10**MOST_DIGITS:
        return f".{max(decimals, 0)}f"
    return f".{max(int(f'{largest:e}'.partition('e')[2]) + decimals, 0)}e"


def with_error(value: float | None, error: float | None) -> tuple[Number, Number]:
    """Return the cells of a number and its error: the error with two digits, and the number with as many decimals."""
    form = digits(math.nan if error is None else error, value)
    return Number(value, form), Number(error, form if "e" not in form else ".1e")


def estimates(title: str, rows: "Iterable[tuple[str, Estimate]]", notes: Sequence[str] = ()) -> Table:
    """Return a table of named estimates: value, standard error, samples, theory, error of theory and deviation."""
    rows = list(rows)
    rough = any(estimate.theory_error > 0 for _, estimate in rows)

    def cells(name: str, estimate: "Estimate") -> tuple[Cell, ...]:
        by_law = math.isinf(estimate.independent_samples)
        samples = Number(estimate.independent_samples, ".0f", instead="" if by_law else None)
        instead = (
            "exact" if by_law and estimate.standard_error == 0 else "" if math.isnan(estimate.standard_error) else None
        )
        value, spread = with_error(estimate.value, estimate.standard_error)
        known = (
            with_error(estimate.theory, estimate.theory_error)
            if estimate.theory_error
            else (Number(estimate.theory), Number(0.0))
        )
        theory = (known if rough else known[:1]) if estimate.theory is not None else (Number(None),) * (1 + rough)
        return name, value, spread._replace(instead=instead), samples, *theory, Number(estimate.deviation, "+.2f")

    heads = (*ESTIMATE_HEADS[:-1], *[THEORY_ERROR] * rough, ESTIMATE_HEADS[-1])
    return Table(title, heads, [cells(*row) for row in rows], notes, estimates=[estimate for _, estimate in rows])


def pressure_table(tensor: "Mapping[str, Estimate]") -> Table:
    """Return the table of the components of the pressure tensor, given by name."""
    return estimates(
        "Pressure tensor (energy/length²)", [(f"P {name}", component) for name, component in tensor.items()]
    )


def time_series(title: str, columns: Mapping[str, "np.ndarray | None"], notes: Sequence[str] = ()) -> Table:
    """Return a table with a column for each series (n,) that is not None; the terminal shows SHOWN_ROWS of its rows.

    Cells with values that are not finite are empty. A column whose name begins with ± contains the errors of the column
    before it.
    """
    shown = {name: values.tolist() for name, values in columns.items() if values is not None}
    rows = [[Number(x if math.isfinite(x) else None) for x in row] for row in zip(*shown.values(), strict=True)]
    for k, name in enumerate(shown):
        for row in rows if name.startswith("±") else ():
            row[k - 1 : k + 1] = with_error(row[k - 1].value, row[k].value)
    return Table(title, tuple(shown), rows, notes, most=SHOWN_ROWS)


def as_text(tables: Iterable[Table]) -> str:
    """Return tables as plain text, each after its notes, with aligned columns and right-aligned numbers."""
    lines: list[str] = []
    for table in tables:
        lines += table.notes
        if not (rows := table.shown):
            continue
        widths = [max(map(len, column)) for column in zip(table.heads, *rows, strict=True)]
        left = [all(isinstance(row[k], str) for row in table.rows) for k in range(len(widths))]
        lines.append(table.title)
        for cells in (table.heads, *rows):
            padded = (f"{cell:{'<' if text else '>'}{n}}" for cell, n, text in zip(cells, widths, left, strict=True))
            lines.append("  ".join(padded).rstrip())
        lines.append("")
    return "\n".join(lines).rstrip("\n")


def format_estimate(estimate: "Estimate") -> str:
    """Return an estimate with its standard error in units of its last digit, see `with_last_digits`."""
    return with_last_digits(estimate.value, estimate.standard_error)


def escape(text: str) -> str:
    """Return text as HTML that is displayed literally, in an element or in an attribute."""
    return html.escape(plain(text))


def html_table(table: Table) -> str:
    """Return the displayed rows of a table as HTML, with its title as caption and without its notes."""
    heads = [escape(head) for head in table.heads]
    head = "".join(f"<th>{head}</th>" if head else "<td></td>" for head in heads)
    head = f"<tr>{head}</tr>" if any(heads) else ""
    body = "".join(f"<tr>{''.join(_cells(heads, cells))}</tr>" for cells in table.shown)
    return f"<table><caption>{escape(table.title)}</caption>{head}{body}</table>"


def _cells(heads: Iterable[str], cells: Iterable[str]) -> Iterator[str]:
    """Yield the cells of a row, each with the heading of its column, for pages that are too narrow for table rows."""
    for head, cell in zip(heads, cells, strict=True):
        yield f'<td data-head="{head}">{escape(cell)}</td>' if head else f"<td>{escape(cell)}</td>"


def html_tables(tables: Iterable[Table]) -> str:
    """Return tables one below the other, each after its notes, as a notebook displays them."""
    parts = []
    for table in tables:
        parts += [f"<p>{escape(note)}</p>" for note in table.notes]
        parts += [html_table(table)] if table.rows else []
    return f"<div>{''.join(parts)}</div>"


BAR_WIDTH = 50
"""Number of characters in the longest bar of a histogram."""


def bars(lows: Sequence[float], density: Sequence[float], law: Sequence[float] | None) -> str:
    """Return a line for each bin: its lower edge, a bar of length proportional to the density, and a mark for theory.

    Args:
        lows: lower edges of the bins.
        density: density in each bin, 1/unit.
        law: theoretical density in each bin; None if theory is not available.
    """
    highest = max(*density, *(law or ())) or 1.0
    names = _aligned([f"{low:.3g}" for low in lows])
    widest = max(map(len, names))
    lines = []
    for k, name in enumerate(names):
        bar = list(("█" * round(BAR_WIDTH * density[k] / highest)).ljust(BAR_WIDTH + 1))
        if law is not None:
            bar[round(BAR_WIDTH * law[k] / highest)] = "│"
        lines.append(f"{name:>{widest}} {''.join(bar).rstrip()}")
    return "\n".join(lines)


def _aligned(numbers: list[str]) -> list[str]:
    """Return numbers with the same number of decimals, unless any is written with a power of ten."""
    decimals = max(len(number.partition(".")[2]) for number in numbers)
    return (
        numbers if any("e" in number for number in numbers) else [f"{float(number):.{decimals}f}" for number in numbers]
    )
