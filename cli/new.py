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

    Beside it a JSON Schema is written, with which editors complete and check the keys of a scene.
    """
    copy_scene(TEMPLATE, Path(f"{name.removesuffix(SCENE)}{SCENE}"), force)
