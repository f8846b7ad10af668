"""Output to the terminal: names, titles and commands from scenes and logs are printed as plain text."""

import io
import os
import sys
from typing import TYPE_CHECKING, Any, NoReturn

import click

from idealgas.errors import OutputError, plain

if TYPE_CHECKING:
    from rich.console import Console

CLOSED_PIPE = 141
"""Exit code after the reader of the output has closed it: 128 + SIGPIPE, as in shells."""

UNBOUNDED = 100_000
"""Width in columns of output that is not a terminal, so that lines are not broken."""

_QUIET = "idealgas_cli.quiet"


def be_quiet(ctx: click.Context, _: click.Parameter, value: bool) -> None:
    """Make a command print only errors, warnings and data that an option requests."""
    ctx.meta[_QUIET] = value


def quiet() -> bool:
    """Whether the command prints only errors, warnings and data."""
    ctx = click.get_current_context(silent=True)
    return ctx is not None and ctx.meta.get(_QUIET, False)


def echo(text: object, err: bool = False) -> None:
    """Print a line, unless the command is quiet; err: to stderr, always."""
    if err or not quiet():
        click.echo(plain(str(text)), err=err)


def data(text: str, nl: bool = True) -> None:
    """Print data for other programs, also if the command is quiet; nl: whether to end it with a new line."""
    click.echo(plain(text), nl=nl)


def written(path: object, err: bool = False) -> None:
    """Print that a file was written; err: to stderr, because stdout holds data."""
    if not quiet():
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

    console = Plain(stderr=err, markup=False, emoji=False, quiet=quiet())
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = UNBOUNDED
    return console


class _StandardOutput(io.FileIO):
    """Standard output; a write that fails raises OutputError, or BrokenPipeError if the reader has closed the pipe."""

    def write(self, data: Any) -> int:
        """Write bytes and return their number; after a failure, everything that follows is dropped."""
        try:
            return super().write(data)
        except OSError as error:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())  # takes what is still in the buffers
            if isinstance(error, BrokenPipeError):
                raise
            raise OutputError(f"standard output: cannot be written: {error.strerror}", exit_code=1) from None


def set_up_streams() -> None:
    """Print characters that a stream cannot show as escapes, and report a failing write to standard output."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    old = sys.stdout
    buffer = getattr(old, "buffer", None)
    raw = getattr(buffer, "raw", buffer)  # Python may run unbuffered
    if type(raw) is io.FileIO:  # neither a console of Windows nor the memory of a test
        file = io.BufferedWriter(_StandardOutput(raw.fileno(), "wb", closefd=False))
        sys.stdout = io.TextIOWrapper(file, old.encoding, old.errors, line_buffering=old.isatty())
