"""Command `idealgas new`: a scene to start from."""

from pathlib import Path

import click

from ._options import force_option
from ._scenes import SCENE, TEMPLATE, copy_scene


@click.command(epilog="Example: idealgas new gas")
@click.argument("name")
@force_option
def new(name: str, force: bool) -> None:
    """Write a commented scene to start from, NAME.toml.

    A JSON Schema is written to the same folder; editors use it to complete and check keys.
    """
    copy_scene(TEMPLATE, Path(f"{name.removesuffix(SCENE)}{SCENE}"), force)
