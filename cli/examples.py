"""Command `idealgas examples`: list or copy the example scenes."""

import click

from idealgas.errors import UserError
from idealgas.examples import SCENE, names

from ._options import FILE, force_option
from ._progress import progress_bar
from ._scenes import copy_example, notebooks, shown_by
from ._terminal import data, terminal, written


def _complete(_: click.Context, __: click.Parameter, incomplete: str) -> list[str]:
    return [name for name in (*names(), *notebooks()) if name.startswith(incomplete)]


@click.command(epilog="Example: idealgas examples piston")
@click.argument("name", required=False, shell_complete=_complete)
@click.option(
    "-o", "--output", type=FILE, metavar="FILE", help="File to write.  [default: the example's name, in this folder]"
)
@click.option(
    "--gallery",
    type=FILE,
    metavar="PAGE.html",
    help="Write a page with pictures of all examples, or of NAME.",
)
@force_option
def examples(name: str | None, output: str | None, gallery: str | None, force: bool) -> None:
    """List what the example scenes and the notebooks show, or copy one of them.

    When a scene is copied, a JSON Schema is written to the same folder; editors use it to complete and check keys.
    """
    if gallery is not None:
        if output is not None:
            raise UserError("-o and --gallery cannot be combined")
        _write_gallery(gallery, name, force)
        return
    if name is None:
        if output is not None:
            raise UserError("-o: the name of an example is missing (`idealgas examples` lists them)")
        listed = click.HelpFormatter(width=terminal().width)
        listed.write_dl([(each, shown_by(each)) for each in (*names(), *notebooks())])
        data(listed.getvalue(), nl=False)
        return
    copy_example(name, output, force)


def _write_gallery(path: str, name: str | None, force: bool) -> None:
    """Write a page with a picture of each scene, or of the named scene only."""
    from idealgas.gallery import SCENES, write_gallery

    scenes = SCENES if name is None else (name.removesuffix(SCENE),)
    with progress_bar("drawing scenes") as progress:
        write_gallery(path, scenes, force=force, on_scene=lambda k, name: progress(k, len(scenes), name))
    written(path)
