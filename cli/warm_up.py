"""Command `idealgas warm-up`: compile the machine code of scenes in advance."""

import json

import click

from idealgas.examples import paths as shipped

from ._options import FILE, json_option
from ._tables import facts, print_tables
from ._terminal import data, terminal


@click.command(epilog="Example: idealgas warm-up gas.toml")
@click.argument("paths", type=FILE, metavar="[SCENE.toml]...", nargs=-1)
@json_option
def warm_up(paths: tuple[str, ...], as_json: bool) -> None:
    """Compile the machine code of scenes in advance, so that their first run starts at once.

    The machine code for the effects of a scene is cached on disk. If no scene is given, the code for all example scenes
    is compiled.
    """
    from idealgas.run.simulate import warm_up as compile_for
    from idealgas.scene import load_scene

    scenes = {str(path): load_scene(path) for path in paths or shipped()}
    with terminal(err=True).status("compiling"):
        seconds = {path: compile_for(scene) for path, scene in scenes.items()}
    if as_json:
        data(json.dumps({"compile_seconds": seconds}, indent=2))
    else:
        print_tables([facts("Compilation", {path: f"{duration:.1f} s" for path, duration in seconds.items()})])
