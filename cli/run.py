"""Command `idealgas run`: event log of a scene."""

from contextlib import nullcontext
from functools import partial

import click

from idealgas.files import LOG, check_output

from ._options import FILE, force_option, json_option, quiet_option, scene_argument


@click.command(epilog="Example: idealgas run gas.toml -o gas.h5")
@scene_argument
@click.option("-o", "--output", type=FILE, required=True, metavar="RUN.h5", help="The log to write.")
@force_option
@click.option("--watch", is_flag=True, help="Show the run in the browser, until Ctrl-C.")
@json_option
@quiet_option
def run(path: str, overrides: tuple[str, ...], output: str, force: bool, watch: bool, as_json: bool) -> None:
    """Run a scene and write every event into an HDF5 log. After Ctrl-C, `resume` continues the run from its log."""
    from idealgas.scene import load_scene

    scene = load_scene(path, overrides)
    check_output(output, LOG, force, [path])  # before the imports below, which take a second
    from idealgas.run.simulate import simulate

    from ._runs import run_with_progress
    from .watch import watching

    with watching(output) if watch else nullcontext(lambda: None) as show:
        run_with_progress(partial(simulate, scene, output, force=force), output, as_json, on_start=show)
