"""Command `idealgas new`: write a scene to start from."""

import click

from idealgas.examples import SCENE, TEMPLATE, path_of

from ._options import force_option
from ._scenes import copy_example
from ._terminal import data


@click.command(epilog="Example: idealgas new gas")
@click.argument("name")
@force_option
def new(name: str, force: bool) -> None:
    """Write a commented scene to start from as NAME.toml, or to standard output if NAME is -.

    A JSON Schema is written to the same folder; editors use it to complete and check keys.
    """
    if name == "-":
        data(path_of(TEMPLATE + SCENE).read_text(encoding="utf-8"), nl=False)
        return
    copy_example(TEMPLATE, f"{name.removesuffix(SCENE)}{SCENE}", force)
