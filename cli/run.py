"""`idealgas run`: from a scene to its event log."""

import signal
from typing import TYPE_CHECKING

import click

from ._options import json_option, scene_argument

if TYPE_CHECKING:
    from idealgas.simulate import Summary


@click.command()
@scene_argument
@click.option("-o", "--output", required=True, metavar="RUN.h5", help="The log to write.")
@click.option("--force", is_flag=True, help="Replace the log if it exists.")
@json_option
def run(path: str, overrides: tuple[str, ...], output: str, force: bool, as_json: bool) -> None:
    """Run a scene and write every event into an HDF5 log. Ctrl-C ends the run with a readable log."""
    from idealgas.scene import load_scene

    scene = load_scene(path, overrides)
    from idealgas.log import check_output

    check_output(output, force)
    import json
    import shlex
    import sys
    from dataclasses import asdict

    from idealgas.simulate import simulate

    from ._progress import progress_bar

    asked_to_stop = []
    signal.signal(signal.SIGINT, lambda *_: asked_to_stop.append(True))
    with progress_bar() as show:
        summary = simulate(
            scene,
            output,
            force=force,
            command=shlex.join(["idealgas", *sys.argv[1:]]),
            on_progress=show,
            interrupted=lambda: bool(asked_to_stop),
        )
    if as_json:
        click.echo(json.dumps(asdict(summary), indent=2))
    else:
        _print(summary, output)
    if asked_to_stop:
        raise SystemExit(130)


def _print(summary: "Summary", output: str) -> None:
    import os

    from rich.console import Console
    from rich.filesize import decimal
    from rich.table import Table

    title = output if summary.completed else f"{output} (interrupted)"
    table = Table(title=title, title_justify="left", show_header=False)
    table.add_column()
    table.add_column(justify="right")
    table.add_row("events", f"{summary.events:,}")
    table.add_row("  disc collisions", f"{summary.disc_collisions:,}")
    table.add_row("  wall hits", f"{summary.wall_hits:,}")
    table.add_row("simulated time", f"{summary.end_time:.6g}")
    table.add_row("energy drift", f"{summary.energy_drift:.1e}")
    table.add_row("deepest overlap", f"{summary.deepest_overlap:.1e} diameters")
    table.add_row("wall time", f"{summary.seconds:.2f} s")
    table.add_row("events per second", f"{summary.events / summary.seconds:,.0f}")
    table.add_row("file size", decimal(os.path.getsize(output)))
    Console().print(table)
