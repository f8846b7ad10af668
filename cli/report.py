"""Command `idealgas report`: write a page with the results of all analyses of a log."""

import click

from ._analysis import log_argument, open_log
from ._options import FILE, force_option, quiet_option
from ._progress import progress_bar
from ._terminal import written


@click.command(epilog="Example: idealgas report gas.h5 -o gas.html")
@log_argument
@click.option("-o", "--output", type=FILE, required=True, metavar="REPORT.html", help="The page to write.")
@click.option(
    "--from",
    "start",
    type=float,
    metavar="T",
    help="Start of the motion in the player, in simulated time.  [default: the log's start]",
)
@force_option
@quiet_option
def report(path: str, output: str, start: float | None, force: bool) -> None:
    """Write an HTML page with all applicable analyses and a player that shows the motion.

    The page is a single file and requires no network connection. If the run is long, the player shows only part of it,
    and the page states which part.
    """
    from idealgas.report.page import write_report

    with open_log(path) as log, progress_bar("reading analyses") as progress:
        write_report(log, output, start=start, force=force, on_step=progress)
    written(output)
