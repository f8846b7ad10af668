"""Command `idealgas examples`: the example scenes."""

from pathlib import Path

import click

from idealgas.errors import UserError

from ._options import force_option
from ._scenes import SCENE, copy_scene, names, title
from ._terminal import data


@click.command(epilog="Example: idealgas examples piston")
@click.argument("name", required=False)
@click.option("-o", "--output", metavar="FILE.toml", help="File to write.  [default: NAME.toml in this folder]")
@force_option
def examples(name: str | None, output: str | None, force: bool) -> None:
    """List the example scenes, or copy one of them.

    A JSON Schema is written to the same folder; editors use it to complete and check keys.
    """
    if name is None:
        if output is not None:
            raise UserError("-o: the name of an example is missing (`idealgas examples` lists them)")
        width = max(map(len, names()))
        for each in names():
            data(f"{each:{width}}  {title(each)}")
        return
    name = name.removesuffix(SCENE)
    copy_scene(name, Path(output or f"{name}{SCENE}"), force)
