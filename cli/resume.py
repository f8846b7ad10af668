"""`idealgas resume`: go on with a run."""

from typing import Any

import click

from ._analysis import log_argument
from ._options import json_option


@click.command()
@log_argument
@click.option("--until", type=float, metavar="T", help="End at this time.")
@click.option("--events", type=int, metavar="N", help="End after this number of events since time 0.")
@click.option("--collisions-per-disc", type=float, metavar="X", help="End after these collisions a disc since time 0.")
@click.option("--trials", type=int, metavar="N", help="With monte_carlo: end after this number of trials since time 0.")
@json_option
def resume(path: str, as_json: bool, **ends: Any) -> None:
    """Go on with a run that was interrupted, was killed, or is to end later, from its last checkpoint.

    The log becomes what a run without a break would have written, bit for bit. A new end replaces all stop rules of the
    scene.
    """
    from functools import partial

    from idealgas.run.resume import resume as go_on

    from ._runs import carry_out

    overrides = [f"run.{rule}={'' if value is None else value}" for rule, value in ends.items()]
    given = any(value is not None for value in ends.values())
    carry_out(partial(go_on, path, overrides if given else ()), path, as_json, from_start=False)
