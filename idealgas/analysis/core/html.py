"""Tables of results as HTML, for the report page and for notebooks."""

import html
from collections.abc import Iterable, Iterator

from idealgas.analysis.core.tables import Table
from idealgas.plain import plain


def escape(text: str) -> str:
    """A text as HTML that shows it as it is, in an element or in an attribute."""
    return html.escape(plain(text))


def html_table(table: Table) -> str:
    """The rows of a table that are shown, with its title as caption; its notes are not part of it."""

    def row(cells: Iterable[str], tag: str) -> Iterator[str]:
        yield "<tr>"
        for cell in cells:
            yield f"<{tag}>{escape(cell)}</{tag}>"
        yield "</tr>"

    head = "".join(row(table.heads, "th")) if any(table.heads) else ""
    body = "".join("".join(row(cells, "td")) for cells in table.shown)
    return f"<table><caption>{escape(table.title)}</caption>{head}{body}</table>"


def html_tables(tables: Iterable[Table]) -> str:
    """Tables one below another, each after its notes, as a notebook shows them."""
    parts = []
    for table in tables:
        parts += [f"<p>{escape(note)}</p>" for note in table.notes]
        parts += [html_table(table)] if table.rows else []
    return f"<div>{''.join(parts)}</div>"
