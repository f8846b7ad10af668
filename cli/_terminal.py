"""The way of every text to the terminal: names, titles and commands of scenes and logs are shown as plain text."""

from typing import TYPE_CHECKING, Any

import click

from idealgas.plain import plain

if TYPE_CHECKING:
    from rich.console import Console


def echo(text: object, err: bool = False, nl: bool = True) -> None:
    """Print a text as it is; err: to stderr. nl: whether a new line comes after it."""
    click.echo(plain(str(text)), err=err, nl=nl)


def terminal(err: bool = False) -> "Console":
    """Console for tables and progress bars, in which no text is markup; err: on stderr."""
    from rich.console import Console
    from rich.text import Text

    class Plain(Console):
        def render_str(self, text: str, **options: Any) -> Text:
            return super().render_str(plain(text), **options)

    return Plain(stderr=err, markup=False, emoji=False)
