"""Tables of results: one source of rows for the terminal, for CSV and for the page of a report."""

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from idealgas.analysis.core.collisions import CollisionRate, FreePath
from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.window import Window


class Number(NamedTuple):
    """A number in a table. digits: its format for people; absent: what they read where there is no value."""

    value: float | None
    digits: str = ".6g"
    absent: str = ""

    def __str__(self) -> str:
        return self.absent if self.value is None else f"{self.value:{self.digits}}"


Cell = str | Number


@dataclass(frozen=True)
class Table:
    """A table of a result. heads: of the columns, the first of them names what a row is about.

    notes: lines that people read before the rows. most: rows that people see at most, evenly taken; CSV has them all.
    """

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    notes: Sequence[str] = ()
    most: int | None = None

    @property
    def shown(self) -> list[list[str]]:
        """The rows that people see, as text."""
        rows, last = self.rows, len(self.rows) - 1
        if self.most is not None and last >= self.most:
            rows = [rows[round(last * k / (self.most - 1))] for k in range(self.most)]
        return [[str(cell) for cell in row] for row in rows]


ESTIMATE_HEADS = ("", "value", "± s.e.", "samples", "theory", "dev./s.e.")

CSV_HEADS = {"": "name", "± s.e.": "standard_error", "samples": "independent_samples", "dev./s.e.": "deviation"}
"""What columns are called in CSV, where not as people read it: as in the results of a sweep."""


def estimates(title: str, rows: Iterable[tuple[str, Estimate]], notes: Sequence[str] = ()) -> Table:
    """A table of named estimates, each with its error bar and beside theory."""

    def cells(name: str, found: Estimate) -> tuple[Cell, ...]:
        samples = Number(found.independent_samples, ".0f")
        theory, deviation = Number(found.theory), Number(found.deviation, "+.2f")
        return name, Number(found.value), Number(found.standard_error, ".2g"), samples, theory, deviation

    return Table(title, ESTIMATE_HEADS, [cells(*row) for row in rows], notes)


def collision_tables(rates: Iterable[CollisionRate], paths: Iterable[FreePath]) -> list[Table]:
    """How often discs of each species collide, and how far and how long they fly in between."""
    between = [
        (f"{entry.species}: {name}", value)
        for entry in paths
        for name, value in (
            ("mean free path", entry.path),
            ("mean free time", entry.time),
            ("mean speed", entry.speed),
        )
    ]
    return [
        estimates("Collisions per disc (1/time)", [(f"{r.species} with {r.other}", r.rate) for r in rates]),
        estimates("Between collisions of a disc (in units of length and time)", between),
    ]


def describe(window: Window) -> str:
    """One line on the window of time that was used."""
    how = "from detected equilibrium" if window.detected else "as asked"
    return f"window: t = {window.start:.6g} to {window.end:.6g} ({how})"


def as_csv(tables: Iterable[Table]) -> str:
    """All rows of all tables under one line of heads: first the title of the table, then every column of any of them.

    Numbers have all their digits; what a table does not have is left empty, and so is what is not a number.
    """
    rows: list[dict[str, str | float]] = []
    for table in tables:
        names = ("table", *(CSV_HEADS.get(head, head) for head in table.heads))
        rows += (dict(zip(names, (table.title, *map(_plain, row)), strict=True)) for row in table.rows)
    file = io.StringIO()
    columns = list(dict.fromkeys(name for row in rows for name in row)) or ["table"]
    writer = csv.DictWriter(file, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return file.getvalue()


def _plain(cell: Cell) -> str | float:
    if isinstance(cell, str):
        return cell
    return "" if cell.value is None or not math.isfinite(cell.value) else cell.value
