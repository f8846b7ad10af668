"""Functions that print to the terminal; text from scenes and logs is printed without interpreting markup."""

import io
import os
import sys
from typing import TYPE_CHECKING, Any, NoReturn

import click

from idealgas.errors import OutputError, plain

if TYPE_CHECKING:
    from rich.console import Console

CLOSED_PIPE = 141
"""Exit code after the reader of the output has closed the pipe: 128 + SIGPIPE, as in shells."""

UNBOUNDED = 100_000
"""Width in characters of output that is not a terminal, large enough that lines are never broken."""

_QUIET = "idealgas_cli.quiet"


def be_quiet(ctx: click.Context, _: click.Parameter, value: bool) -> None:
    """Make a command print only errors, warnings, and the data requested with an option."""
    ctx.meta[_QUIET] = value


def quiet() -> bool:
    """Return whether the command prints only errors, warnings and requested data."""
    ctx = click.get_current_context(silent=True)
    return ctx is not None and ctx.meta.get(_QUIET, False)


def echo(text: object, err: bool = False) -> None:
    """Print a line unless the command is quiet. err: print it to stderr, even if the command is quiet."""
    if err or not quiet():
        click.echo(plain(str(text)), err=err)


def data(text: str, nl: bool = True) -> None:
    """Print data for other programs, even if the command is quiet. nl: whether to end with a newline."""
    click.echo(plain(text), nl=nl)


def written(path: object, err: bool = False) -> None:
    """Print that a file was written. err: print to stderr, because stdout carries data."""
    if not quiet():
        echo(f"{path}: written", err=err)


def terminal(err: bool = False) -> "Console":
    """Return a console for tables and progress bars that prints markup as plain text. err: print to stderr."""
    from rich.console import Console
    from rich.text import Text

    class Plain(Console):
        def render_str(self, text: str, **options: Any) -> Text:
            return super().render_str(plain(text), **options)

        def on_broken_pipe(self) -> NoReturn:
            raise BrokenPipeError

    console = Plain(stderr=err, markup=False, emoji=False, quiet=quiet())
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = UNBOUNDED
    return console


class _StandardOutput(io.FileIO):
    """Standard output that raises BrokenPipeError if the reader closed the pipe, or OutputError if a write fails."""

    def write(self, data: Any) -> int:
        """Write bytes and return their number; after a failure, all further output is dropped."""
        try:
            return super().write(data)
        except OSError as error:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())  # discards the data still in the buffers
            if isinstance(error, BrokenPipeError):
                raise
            raise OutputError(f"standard output: cannot be written: {error.strerror}", exit_code=1) from None


def set_up_streams() -> None:
    """Set up the standard streams.

    Characters that a stream cannot encode are printed as escape sequences, and a failed write to standard output raises
    an error.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    old = sys.stdout
    buffer = getattr(old, "buffer", None)
    raw = getattr(buffer, "raw", buffer)  # without a buffer if Python runs unbuffered
    if type(raw) is io.FileIO:  # not a Windows console, and not an in-memory stream as in tests
        file = io.BufferedWriter(_StandardOutput(raw.fileno(), "wb", closefd=False))
        sys.stdout = io.TextIOWrapper(file, old.encoding, old.errors, line_buffering=old.isatty())
