"""Tables of results as HTML, for the report page and for notebooks."""

import html
from collections.abc import Iterable, Iterator

from idealgas.analysis.core.tables import Table
from idealgas.errors import plain


def escape(text: str) -> str:
    """A text as HTML that shows it as it is, in an element or in an attribute."""
    return html.escape(plain(text))


def html_table(table: Table) -> str:
    """The rows of a table that are shown, with its title as caption; its notes are not part of it."""
    heads = [escape(head) for head in table.heads]
    head = f"<tr>{''.join(f'<th>{head}</th>' for head in heads)}</tr>" if any(heads) else ""
    body = "".join(f"<tr>{''.join(_cells(heads, cells))}</tr>" for cells in table.shown)
    return f"<table><caption>{escape(table.title)}</caption>{head}{body}</table>"


def _cells(heads: Iterable[str], cells: Iterable[str]) -> Iterator[str]:
    """Cells of a row; each knows the heading of its column, for pages that are too narrow for rows."""
    for head, cell in zip(heads, cells, strict=True):
        yield f'<td data-head="{head}">{escape(cell)}</td>' if head else f"<td>{escape(cell)}</td>"


def html_tables(tables: Iterable[Table]) -> str:
    """Tables one below another, each after its notes, as a notebook shows them."""
    parts = []
    for table in tables:
        parts += [f"<p>{escape(note)}</p>" for note in table.notes]
        parts += [html_table(table)] if table.rows else []
    return f"<div>{''.join(parts)}</div>"
