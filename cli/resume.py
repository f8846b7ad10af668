"""Command `idealgas resume`: continue a run."""

from functools import partial
from typing import Any

import click

from ._analysis import log_argument
from ._options import integer, json_option, quiet_option


@click.command(epilog="Example: idealgas resume gas.h5 --until 200")
@log_argument
@click.option("--until", type=float, metavar="T", help="End at this simulated time.")
@click.option("--events", type=integer, metavar="N", help="End after this number of events since time 0.")
@click.option(
    "--collisions-per-disc", type=float, metavar="X", help="End after this number of collisions per disc since time 0."
)
@click.option(
    "--trials", type=integer, metavar="N", help="With monte_carlo: end after this number of trials since time 0."
)
@json_option
@quiet_option
def resume(path: str, as_json: bool, **ends: Any) -> None:
    """Continue an interrupted or killed run from its last checkpoint, or a finished run to a later end.

    The resulting log is bit for bit that of an uninterrupted run. A new end replaces all stop conditions of the scene.
    """
    from idealgas.run.resume import resume as resume_run

    from ._runs import run_with_progress

    overrides = [f"run.{rule}={'' if value is None else value}" for rule, value in ends.items()]
    given = any(value is not None for value in ends.values())
    run_with_progress(partial(resume_run, path, overrides if given else ()), path, as_json, from_start=False)
