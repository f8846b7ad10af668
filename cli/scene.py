"""Command `idealgas scene`: write a scene that starts from a state of a log."""

import os
from pathlib import Path
from typing import Literal

import click

from idealgas.files import check_output, replacing

from ._options import FILE, force_option
from ._terminal import written


def _instant(_: click.Context, __: click.Parameter, value: str) -> float | Literal["end"]:
    if value == "end":
        return "end"
    try:
        return float(value)
    except ValueError:
        raise click.BadParameter(f"{value!r} is not a time or 'end'.") from None


@click.command(epilog="Example: idealgas scene gas.h5 -o next.toml")
@click.argument("path", type=FILE, metavar="RUN.h5")
@click.option(
    "--at", "time", metavar="T", default="end", show_default=True, callback=_instant, help="Time of the state."
)
@click.option("-o", "--output", type=FILE, required=True, metavar="SCENE.toml", help="The scene to write.")
@force_option
def scene(path: str, time: float | Literal["end"], output: str, force: bool) -> None:
    """Write a scene that starts at time 0 from a state of a log, with the box, effects and run settings of the log."""
    check_output(output, "scene", force, [path])
    from idealgas.log import open_log
    from idealgas.log.start import continued_scene

    target = Path(output)
    source = os.path.relpath(Path(path).absolute(), target.absolute().parent)
    with open_log(path) as log:
        text = continued_scene(log, time, source)
    with replacing(target, force) as part:
        part.write_text(f"#:schema scene.schema.json\n\n{text}", encoding="utf-8", newline="\n")
    written(target)
