"""Command `idealgas info`: show the contents of a log."""

from typing import TYPE_CHECKING, Any

import click

from ._analysis import log_argument, open_log, print_json
from ._options import json_option
from ._tables import print_tables
from ._terminal import echo

if TYPE_CHECKING:
    from idealgas.presentation.tables import Table


@click.command(epilog="Example: idealgas info gas.h5")
@log_argument
@json_option
def info(path: str, as_json: bool) -> None:
    """Show the contents of a log: its scene, its discs, and the state of its run."""
    from idealgas.analysis.info import info as describe_log

    with open_log(path) as log:
        facts = describe_log(log)
    if as_json:
        print_json(facts)
        return
    print_tables(
        _table(name, {key: value for key, value in values.items() if key != "species"})
        for name, values in facts.items()
    )
    for species in facts["gas"]["species"]:
        echo("species: " + ", ".join(f"{key} {_text(value)}" for key, value in species.items()))


def _table(title: str, values: dict[str, Any]) -> "Table":
    from idealgas.presentation.tables import Table

    return Table(title, ("", ""), [(key.replace("_", " "), _text(value)) for key, value in values.items()])


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return "\n".join(f"{key.replace('_', ' ')}: {_text(entry)}" for key, entry in value.items()) or "none"
    if isinstance(value, list):
        return ", ".join(_text(entry) for entry in value) or "none"
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
