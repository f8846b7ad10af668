"""Printing of result tables on the terminal."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from ._terminal import echo, terminal

if TYPE_CHECKING:
    from idealgas.analysis.core.tables import Table

MANY_COLUMNS = 8
"""Largest number of columns of a table with lines between them; wider tables have none."""


def print_tables(tables: "Iterable[Table]") -> None:
    """Print tables one below another, each after its notes."""
    from rich import box
    from rich.table import Table

    console = terminal()
    for found in tables:
        for note in found.notes:
            echo(note)
        if not found.rows:
            continue
        table = Table(title=found.title, title_justify="left")
        if len(found.heads) > MANY_COLUMNS:
            table.box, table.padding = box.SIMPLE, (0, 1, 0, 0)
        for k, head in enumerate(found.heads):
            text = k == 0 and isinstance(found.rows[0][k], str)
            table.add_column(head, justify="left" if text else "right")
        for row in found.shown:
            table.add_row(*row)
        console.print(table)
