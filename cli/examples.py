"""Command `idealgas examples`: the example scenes."""

from pathlib import Path

import click

from idealgas.errors import UserError

from ._options import FILE, force_option
from ._scenes import SCENE, copy_scene, names, shown_by
from ._terminal import data, terminal


def _complete(_: click.Context, __: click.Parameter, incomplete: str) -> list[str]:
    return [name for name in names() if name.startswith(incomplete)]


@click.command(epilog="Example: idealgas examples piston")
@click.argument("name", required=False, shell_complete=_complete)
@click.option(
    "-o", "--output", type=FILE, metavar="FILE.toml", help="File to write.  [default: NAME.toml in this folder]"
)
@force_option
def examples(name: str | None, output: str | None, force: bool) -> None:
    """List what the example scenes show, or copy one of them.

    A JSON Schema is written to the same folder; editors use it to complete and check keys.
    """
    if name is None:
        if output is not None:
            raise UserError("-o: the name of an example is missing (`idealgas examples` lists them)")
        listed = click.HelpFormatter(width=terminal().width)
        listed.write_dl([(each, shown_by(each)) for each in names()])
        data(listed.getvalue(), nl=False)
        return
    name = name.removesuffix(SCENE)
    copy_scene(name, Path(output or f"{name}{SCENE}"), force)
