"""Every command that reads a log, taken from the program itself, in all forms that go their own way."""

import itertools
from collections.abc import Iterator, Sequence

import click
from idealgas_cli.main import main

NAME = "run.h5"

Form = tuple[str, ...]
"""A command, as the words after `idealgas`."""

NEEDED = {"animate": "-o film.gif --to 1 --fps 2 --size 320x240", "report": "-o page.html", "follow": "--once"}
"""What a command cannot do without, or not end without."""
BESIDE = {"recover": ("-o whole.h5",), "pressure": ("--plot picture.png", "--csv")}
"""Further forms of a command, beside those that its options have by themselves."""
SLOW = ("report", "animate")


def reading_commands() -> tuple[str, ...]:
    """Names of the commands whose argument is a log."""
    context = click.Context(main)
    found = {name: main.get_command(context, name) for name in main.list_commands(context)}
    return tuple(name for name, command in found.items() if command and _reads(command))


def forms(name: str) -> tuple[Form, ...]:
    """All forms of a command."""
    command = main.get_command(click.Context(main), name)
    assert command is not None
    return tuple((name, NAME, *words.split()) for words in _options(name, command))


def in_turn(of: Sequence[Form], each: int | None, case: int) -> Sequence[Form]:
    """So many of some forms for a case, and after some cases all of them; without a number all at once."""
    return of if each is None else [of[(each * case + more) % len(of)] for more in range(each)]


def _reads(command: click.Command) -> bool:
    return any(isinstance(p, click.Argument) and (p.metavar or "").startswith(NAME.upper()[:3]) for p in command.params)


def _options(name: str, command: click.Command) -> Iterator[str]:
    options = {option for parameter in command.params for option in parameter.opts}
    if name == "export":
        kinds = next(p.type.choices for p in command.params if p.name == "kind")
        for kind, rows in itertools.product(kinds, ("--frames 3", "--events")):
            if rows == "--frames 3" or kind in ("csv", "parquet"):
                yield f"--format {kind} {rows} -o out.{kind}"
        return
    first = NEEDED.get(name, "--json" if "--json" in options else "")
    yield first
    yield from BESIDE.get(name, ())
    for parameter in command.params:
        if isinstance(parameter.type, click.Choice) and name not in NEEDED:
            for choice in parameter.type.choices:
                if choice != parameter.default:
                    yield f"{parameter.opts[0]} {choice} {first}"
