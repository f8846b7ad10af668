"""Command `idealgas run`: run a scene and write its log."""

from contextlib import nullcontext
from functools import partial

import click

from idealgas.errors import UserError
from idealgas.files import LOG, check_output

from ._options import FILE, force_option, json_option, quiet_option, scene_argument


@click.command(epilog="Example: idealgas run gas.toml -o gas.h5")
@scene_argument
@click.option("-o", "--output", type=FILE, required=True, metavar="RUN.h5", help="The log to write.")
@force_option
@click.option("--watch", is_flag=True, help="Show the run in the browser until Ctrl-C.")
@click.option("--stream", is_flag=True, help="Print each event as a line of JSON; the run waits for a slow reader.")
@json_option
@quiet_option
def run(
    path: str, overrides: tuple[str, ...], output: str, force: bool, watch: bool, stream: bool, as_json: bool
) -> None:
    """Run a scene and write every event to an HDF5 log. After Ctrl-C, `resume` continues the run from its log.

    With --stream, the events are also printed, in the format of `idealgas events`; the run ends when the reader closes
    the pipe.
    """
    from idealgas.scene import load_scene

    if stream and (as_json or watch):
        raise UserError("--stream cannot be combined with --json or --watch")
    scene = load_scene(path, overrides)
    if stream and not scene.log.events:
        raise UserError(f"{path}: --stream requires events (got log.events = false)")
    check_output(output, LOG, force, [path])  # checked before the imports below, which take a second
    from idealgas.analysis import registry
    from idealgas.run.simulate import simulate

    from ._runs import run_with_progress
    from .events import EventStream
    from .watch import watching

    printed = EventStream() if stream else None
    with watching(output) if watch else nullcontext(lambda: None) as show:
        run_with_progress(
            partial(simulate, scene, output, force=force, on_events=printed),
            output,
            as_json,
            on_start=show,
            stream=printed,
            shows=registry.shown(scene),
        )
