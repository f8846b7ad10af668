"""The way of every text to the terminal: names, titles and commands of scenes and logs are shown as plain text."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NoReturn

import click

from idealgas.errors import plain

if TYPE_CHECKING:
    from rich.console import Console

CLOSED_PIPE = 141
"""Exit code where the reader of the output has gone: 128 + SIGPIPE, as shells have it."""

UNBOUNDED = 100_000
"""Width of output that is not a terminal, in columns: lines are not broken."""

_QUIET = "idealgas_cli.quiet"


def be_quiet(ctx: click.Context, _: click.Parameter, quiet: bool) -> None:
    """Let a command print nothing but errors, warnings and what is asked for with an option of its own."""
    ctx.meta[_QUIET] = quiet


def _quiet() -> bool:
    ctx = click.get_current_context(silent=True)
    return ctx is not None and ctx.meta.get(_QUIET, False)


def echo(text: object, err: bool = False) -> None:
    """Print a line as it is; err: to stderr, also of a quiet command."""
    if err or not _quiet():
        click.echo(plain(str(text)), err=err)


def data(text: str, nl: bool = True) -> None:
    """Print what is made for other programs, also of a quiet command; nl: whether a new line comes after it."""
    click.echo(plain(text), nl=nl)


def written(path: object, err: bool = False) -> None:
    """Say that a file has been written; err: on stderr, where stdout is for other programs."""
    if not _quiet():
        echo(f"{path}: written", err=err)


def terminal(err: bool = False) -> "Console":
    """Console for tables and progress bars, in which no text is markup; err: on stderr."""
    from rich.console import Console
    from rich.text import Text

    class Plain(Console):
        def render_str(self, text: str, **options: Any) -> Text:
            return super().render_str(plain(text), **options)

        def on_broken_pipe(self) -> NoReturn:
            raise BrokenPipeError

    console = Plain(stderr=err, markup=False, emoji=False, quiet=_quiet())
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = UNBOUNDED
    return console


@contextmanager
def readers_may_go() -> Iterator[None]:
    """End the program quietly when the reader of its output, such as `head`, has gone."""
    try:
        yield
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # there goes what is still to be flushed
        raise SystemExit(CLOSED_PIPE) from None
