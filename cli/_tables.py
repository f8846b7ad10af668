"""Print tables on the terminal without cutting off digits, whatever its width."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from idealgas.errors import UserError, install, plain
from idealgas.files import written

from ._terminal import UNBOUNDED, echo, terminal

if TYPE_CHECKING:
    import numpy as np
    from rich.console import Console, ConsoleOptions
    from rich.segment import Segment
    from rich.text import Text

    from idealgas.presentation.tables import Number, Table

MANY_COLUMNS = 8
"""Largest number of columns for which a table has lines between its columns."""

TEXT = 16
"""Width in characters to which text columns may shrink (or to their longest word) before a table is divided."""


def print_tables(tables: "Iterable[Table]") -> None:
    """Print tables one below the other, each preceded by its notes."""
    console = terminal()
    width, console.width = console.width, UNBOUNDED  # Rich must not break the lines that `as_rich` has fitted
    for table in tables:
        for note in table.notes:
            echo(note)
        for part in as_rich(table, width):
            console.print(part)


def write_columns(columns: "Mapping[str, np.ndarray]", path: str, force: bool) -> None:
    """Write columns (n,), by name, to a file with extension .csv or .parquet."""
    try:
        from pyarrow import csv, parquet, table
    except ModuleNotFoundError as error:
        raise UserError(f"{path} requires {error.name}: {install('export')}") from error
    kind = Path(path).suffix.lower()
    with written(path, kind, force) as part:
        (csv.write_csv if kind == ".csv" else parquet.write_table)(table(dict(columns)), str(part))


def shown(text: str) -> "Number":
    """Return a cell for a number that is already formatted; the cell is right-aligned and never broken."""
    from idealgas.presentation.tables import Number

    return Number(None, absent=text)


def facts(title: str, values: Mapping[str, str]) -> "Table":
    """Return a table with a row for each name and value."""
    from idealgas.presentation.tables import Table

    return Table(title, ("", ""), [(name, shown(value)) for name, value in values.items()])


class _Column(NamedTuple):
    """Column of a table: heading, cells, whether the cells are text, and natural and smallest width in characters."""

    head: str
    cells: Sequence[str]
    text: bool
    natural: int
    least: int


def as_rich(table: "Table", width: int) -> "Iterator[Text | _Drawing]":
    """Yield the title of a table and then the table itself, for a terminal of a given width in characters.

    If the terminal is too narrow, the table is divided into parts, each of which repeats the first column. Text is
    broken between words; numbers are never broken.
    """
    from rich.text import Text

    if not table.shown:
        return
    first, *remaining = _columns(table)
    dense = len(table.heads) > MANY_COLUMNS
    between, around = (1, 2) if dense else (3, 1)  # characters between two columns, and at both ends in total
    if table.title:
        yield Text(plain(table.title), style="italic")
    while remaining:
        fitting = _fitting(first, remaining, width - around, between)
        taken, remaining = [first, *remaining[:fitting]], remaining[fitting:]
        widths = _widths(taken, width - around - between * len(taken))
        yield _Drawing(taken, widths, dense)


def _columns(table: "Table") -> list[_Column]:
    from rich.cells import cell_len

    columns = []
    for k, head in enumerate(table.heads):
        head, cells = plain(head), [plain(row[k]) for row in table.shown]
        text = all(isinstance(row[k], str) for row in table.rows)
        words = max((cell_len(word) for cell in (head, *(cells if text else ())) for word in cell.split()), default=0)
        natural = max(cell_len(line) for cell in (head, *cells) for line in (cell.splitlines() or [""]))
        least = max(words, min(natural, TEXT)) if text else max(words, *map(cell_len, cells))
        columns.append(_Column(head, cells, text, natural, min(least, natural)))
    return columns


def _fitting(first: _Column, remaining: Sequence[_Column], width: int, between: int) -> int:
    """Return how many of the remaining columns (at least one) fit into a width beside the first column."""
    number, used = 0, first.least + between
    for column in remaining:
        used += column.least + between
        if number and used > width:
            break
        number += 1
    return number


def _widths(columns: Sequence[_Column], width: int) -> list[int]:
    """Return column widths that fit into a total width if possible; the widest columns are narrowed first."""
    widths = [column.natural for column in columns]
    while sum(widths) > width:
        wide = [k for k, column in enumerate(columns) if widths[k] > column.least]
        if not wide:
            break
        widths[max(wide, key=lambda k: widths[k])] -= 1
    return widths


class _Drawing(NamedTuple):
    """Table drawn in the style of Rich but in a fraction of the time."""

    columns: Sequence[_Column]
    widths: Sequence[int]
    dense: bool

    def __rich_console__(self, console: "Console", options: "ConsoleOptions") -> "Iterator[Segment]":
        """Yield the lines of the table, with bold headings."""
        from rich import box
        from rich.segment import Segment
        from rich.style import Style

        heads = [column.head for column in self.columns]
        frame = (box.SIMPLE if self.dense else box.HEAVY_HEAD).substitute(options, safe=console.safe_box)
        padded, bold = [width + (1 if self.dense else 2) for width in self.widths], Style(bold=True)
        if not any(heads):
            frame = frame.get_plain_headed_box()
        yield Segment(f"{frame.get_top(padded)}\n")
        if any(heads):
            for line in self._lines(console, heads, at_bottom=True):
                ends = [*[frame.head_vertical] * (len(line) - 1), f"{frame.head_right}\n"]
                yield Segment(frame.head_left)
                for cell, end in zip(line, ends, strict=True):
                    yield from (Segment(cell, bold), Segment(end))
            yield Segment(f"{frame.get_row(padded, 'head')}\n")
        for row in zip(*(column.cells for column in self.columns), strict=True):
            for line in self._lines(console, row):
                yield Segment(f"{frame.mid_left}{frame.mid_vertical.join(line)}{frame.mid_right}\n")
        yield Segment(f"{frame.get_bottom(padded)}\n")

    def _lines(self, console: "Console", row: Sequence[str], at_bottom: bool = False) -> "Iterator[tuple[str, ...]]":
        """Yield each line of a row as padded pieces of its cells; cells are aligned to the top or bottom of the row."""
        from rich.cells import cell_len
        from rich.text import Text

        parts = []
        for cell, width, column in zip(row, self.widths, self.columns, strict=True):
            fits = cell_len(cell) <= width and "\n" not in cell
            lines = (
                [cell] if fits else [text.plain.rstrip() for text in Text(cell).wrap(console, width, overflow="fold")]
            )
            spaces = [" " * (width - cell_len(line)) for line in lines]
            margin = "" if self.dense else " "
            parts.append(
                [
                    f"{margin}{line}{space} " if column.text else f"{margin}{space}{line} "
                    for line, space in zip(lines, spaces, strict=True)
                ]
            )
        height = max(map(len, parts))
        for part, width in zip(parts, self.widths, strict=True):
            empty = [" " * (width + (1 if self.dense else 2))] * (height - len(part))
            part[:] = [*empty, *part] if at_bottom else [*part, *empty]
        yield from zip(*parts, strict=True)
