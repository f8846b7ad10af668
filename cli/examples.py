"""Command `idealgas examples`: the scenes that come with the program."""

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
    """List the scenes that come with the program, or copy one of them.

    Beside the copy a JSON Schema is written, with which editors complete and check the keys of a scene.
    """
    if name is None:
        if output is not None:
            raise UserError("-o: which example? (`idealgas examples` lists them)")
        width = max(map(len, names()))
        for each in names():
            data(f"{each:{width}}  {title(each)}")
        return
    name = name.removesuffix(SCENE)
    copy_scene(name, Path(output or f"{name}{SCENE}"), force)
