"""The command `idealgas`: one command for each module here and for each analysis of the registry.

Command NAME is the function NAME of the module NAME, which is imported when the command is called; modules whose name
starts with an underscore, and this one, are no commands. Commands that analyse a log are made from the declarations of
the analyses.
"""

import io
import logging
import os
import sys
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

import click

from idealgas import __version__
from idealgas.analysis import registry
from idealgas.errors import UserError

from . import __path__ as folder
from ._analysis import analysis_command
from ._interrupt import EXIT_CODE
from ._terminal import echo


class Commands(click.Group):
    """Group of all commands: modules of this folder and analyses. It prints errors of the user as plain lines."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of all commands in alphabetical order."""
        names = (module.name for module in iter_modules(folder))
        modules = (name.replace("_", "-") for name in names if name != "main" and not name.startswith("_"))
        return sorted([*modules, *registry.commands()])

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Command of a name; None if there is none."""
        if name not in self.list_commands(ctx):
            return None
        if name in registry.commands():
            return analysis_command(registry.find(name))
        module = name.replace("-", "_")
        return getattr(import_module(f".{module}", __package__), module)

    def main(self, *args: Any, **options: Any) -> Any:
        """Run the program; characters that the terminal does not have are written out."""
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors="backslashreplace")
        logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it warns where it cannot keep its caches
        return super().main(*args, **options)

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; print a UserError as one line and exit with its code."""
        try:
            _check_threads(os.environ.get("NUMBA_NUM_THREADS", "1"))
            return super().invoke(ctx)
        except UserError as error:
            echo(str(error), err=True)
            ctx.exit(error.exit_code)
        except KeyboardInterrupt:
            echo("interrupted", err=True)
            ctx.exit(EXIT_CODE)
        except MemoryError:
            echo("out of memory: the scene is too large for this machine", err=True)
            ctx.exit(1)


def _check_threads(number: str) -> None:
    """UserError for a value at which numba cannot be imported."""
    if not (number.isascii() and number.isdigit() and int(number)):
        raise UserError(f"NUMBA_NUM_THREADS: no number of threads (got {number}; allowed a whole number >= 1)")


@click.command(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="idealgas")
def main() -> None:
    """Exact simulation of a two-dimensional gas of hard discs, with every event on record."""
