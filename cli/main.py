"""The program `idealgas`, with a command for each module in this folder and for each analysis in the registry.

Command NAME is the function NAME in module NAME, which is imported when the command is called. This module and modules
whose names start with an underscore are not commands. The commands that analyse a log are built from the analysis
classes.
"""

import gc
import logging
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

import click

from idealgas import __version__
from idealgas.analysis import registry
from idealgas.errors import UserError, unknown

from ._analysis import AnalysisCommand
from ._terminal import CLOSED_PIPE, echo, set_up_streams

GROUPS = {
    "Run": ("new", "examples", "schema", "check", "run", "resume", "scene", "recover", "warm-up"),
    "Look": ("info", "digest", "follow", "watch", "animate"),
    "Analyse": tuple(sorted(registry.commands(), key=registry.position_of)),
    "Share": ("report", "export", "events"),
    "Study": ("sweep", "accuracy", "bench"),
}
"""All commands, in the groups and in the order in which `--help` lists them."""

EXAMPLES = {
    "Run": "idealgas new gas",
    "Look": "idealgas info gas.h5",
    "Analyse": "idealgas pressure gas.h5 --plot pressure.png",
    "Share": "idealgas report gas.h5 -o gas.html",
    "Study": "idealgas sweep phi.toml -o phi",
}
"""Example of a command in each group."""


class Commands(click.Group):
    """Group of all commands, which come from the modules in this folder and from the analyses; prints user errors."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands, group by group."""
        return [name for names in GROUPS.values() for name in names]

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Return the command with the given name; None if there is no such command."""
        if name not in self.list_commands(ctx):
            return None
        if name in registry.commands():
            return AnalysisCommand(name)
        module = name.replace("-", "_")
        return getattr(import_module(f".{module}", __package__), module)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of commands: an example for each group, and the first sentence of help for each command."""
        widest = max(map(len, self.list_commands(ctx)))
        for group, names in GROUPS.items():
            commands = [(name, self.get_command(ctx, name)) for name in names]
            rows = [(name.ljust(widest), first_sentence(command)) for name, command in commands if command]
            with formatter.section(f"{group}, as in `{EXAMPLES[group]}`"):
                formatter.write_dl(rows)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse a command line and return the remaining arguments; `help NAME` is the same as `NAME --help`."""
        return super().parse_args(ctx, [*args[1:], "--help"] if args[:1] == ["help"] else args)

    def resolve_command(self, ctx: click.Context, args: list[str]) -> tuple[Any, ...]:
        """Return the name, the command and the arguments of a command line.

        Raises:
            UserError: if the command is unknown; the message suggests the most similar name.
        """
        if self.get_command(ctx, args[0]) is None and not ctx.resilient_parsing:
            raise unknown("command", args[0], [*self.list_commands(ctx), "--version"])
        return super().resolve_command(ctx, args)

    def main(self, *args: Any, **options: Any) -> Any:
        """Run the program."""
        set_up_streams()
        gc.set_threshold(100_000, 50, 50)  # imports create many permanent objects that it would scan repeatedly
        os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # searching for plugins would read all packages
        logging.getLogger("matplotlib").setLevel(logging.ERROR)  # no warnings if its cache cannot be written
        return super().main(*args, **options)

    def make_context(self, *args: Any, **options: Any) -> click.Context:
        """Parse the command line, and print the help if requested; print user errors."""
        with _plain_errors():
            return super().make_context(*args, **options)

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; print user errors."""
        with _plain_errors():
            _check_threads(os.environ.get("NUMBA_NUM_THREADS", "1"))
            return super().invoke(ctx)


@contextmanager
def _plain_errors() -> Iterator[None]:
    """Print errors that a user can correct on one line each, and exit with the code of the error.

    Arguments of the library that an error message names are replaced by the options of the command.
    """
    try:
        yield
        if sys.stdout is not None:
            sys.stdout.flush()
    except click.exceptions.NoArgsIsHelpError:
        raise
    except click.UsageError as error:
        name = error.ctx.command_path if error.ctx else "idealgas"
        message = " ".join(error.format_message().split())
        echo(f"{name}: {message[:1].lower()}{message[1:].rstrip('.')} (`{name} --help` lists the options)", err=True)
        raise SystemExit(error.exit_code) from None
    except UserError as error:
        echo(str(error).replace("force=True", "--force"), err=True)
        raise SystemExit(error.exit_code) from None
    except BrokenPipeError:  # the reader of the output, such as `head`, has closed it
        raise SystemExit(CLOSED_PIPE) from None
    except KeyboardInterrupt:
        echo("interrupted", err=True)
        raise SystemExit(128 + signal.SIGINT) from None
    except MemoryError:
        echo("out of memory: the scene is too large for this machine", err=True)
        raise SystemExit(1) from None


def first_sentence(command: click.Command) -> str:
    """Return the first sentence of the help text of a command, on one line."""
    return command.get_short_help_str(limit=1000)


def _check_threads(number: str) -> None:
    """Raise UserError if NUMBA_NUM_THREADS has a value with which numba cannot be imported."""
    if not (number.isascii() and number.isdigit() and int(number)):
        raise UserError(f"NUMBA_NUM_THREADS: not a number of threads (got {number}; allowed a whole number >= 1)")


@click.command(
    cls=Commands,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="`idealgas COMMAND --help` describes a command and its options.",
)
@click.version_option(__version__, "-V", "--version", prog_name="idealgas")
def main() -> None:
    """Exact simulation of a two-dimensional gas of hard discs, with a log of every event."""
