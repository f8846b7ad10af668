"""Every command that reads a log, taken from the program itself, with its options."""

import itertools
from collections.abc import Iterator

import click
from idealgas_cli.main import main

NAME = "run.h5"

Form = tuple[str, ...]
"""A command, as the words after `idealgas`."""

NEEDED = {
    "animate": "-o film.gif --to 1 --fps 2 --size 320x240",
    "report": "-o page.html",
    "follow": "--once",
    "scene": "--at 1 -o next.toml",
}
"""Options without which a command is incomplete, or does not end."""
FURTHER = {"recover": ("-o whole.h5",), "pressure": ("--plot picture.png", "--csv")}
"""Further forms of a command, in addition to those of its own choices."""
SLOW = ("report", "animate")
ENDLESS = ("watch",)
"""Commands that end with Ctrl-C."""


def reading_commands() -> tuple[str, ...]:
    """Names of the commands whose argument is a log."""
    context = click.Context(main)
    actual = {name: main.get_command(context, name) for name in main.list_commands(context)}
    return tuple(name for name, command in actual.items() if command and _reads(command) and name not in ENDLESS)


def forms(name: str) -> tuple[Form, ...]:
    """All forms of a command."""
    command = main.get_command(click.Context(main), name)
    assert command is not None
    return tuple((name, NAME, *words.split()) for words in _options(name, command))


def _reads(command: click.Command) -> bool:
    arguments = [parameter for parameter in _parameters(command) if isinstance(parameter, click.Argument)]
    return any((argument.metavar or "").startswith("RUN") for argument in arguments)


def _parameters(command: click.Command) -> list[click.Parameter]:
    return command.get_params(click.Context(command))


def _options(name: str, command: click.Command) -> Iterator[str]:
    parameters = _parameters(command)
    options = {option for parameter in parameters for option in parameter.opts}
    if name == "export":
        kinds = next(p.type.choices for p in parameters if p.name == "kind")
        for kind, rows in itertools.product(kinds, ("--frames 3", "--events")):
            if rows == "--frames 3" or kind in ("csv", "parquet"):
                yield f"--format {kind} {rows} -o out.{kind}"
        return
    first = NEEDED.get(name, "--json" if "--json" in options else "")
    yield first
    yield from FURTHER.get(name, ())
    for parameter in parameters:
        if isinstance(parameter.type, click.Choice) and name not in NEEDED:
            for choice in parameter.type.choices:
                if choice != parameter.default:
                    yield f"{parameter.opts[0]} {choice} {first}"
