"""Command `idealgas follow`: show the status of a run in progress."""

import time
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from ._analysis import log_argument
from ._tables import as_rich, facts
from ._terminal import terminal

if TYPE_CHECKING:
    from rich.console import Group

    from idealgas.analysis.status import Status
    from idealgas.log import Log

SECONDS = 1.0  # time between two updates


@click.command(epilog="Example: idealgas follow gas.h5")
@log_argument
@click.option("--once", is_flag=True, help="Show the status once and exit.")
def follow(path: str, once: bool) -> None:
    """Show the status of a run until it ends; if the output is not a terminal, show only the final status.

    Pressure and Z are measured from the latest events, and the distribution of speeds from the latest state.
    """
    from rich.live import Live

    from idealgas.analysis.status import status
    from idealgas.log import open_log

    console = terminal()
    rate: float | None = None
    with open_log(path) as log, Live(console=console, auto_refresh=False, transient=True) as screen:
        seen, looked = status(log), time.monotonic()
        while log.live:
            time.sleep(SECONDS)
            log.refresh()
            before, seen = (seen, looked), status(log)
            looked = time.monotonic()
            rate = (seen.events - before[0].events) / (looked - before[1])
            if once:
                break
            if console.is_terminal:
                screen.update(_view(log, seen, rate, console.width), refresh=True)
    with open_log(path) as log:  # opened again, because the run may have closed it
        if log.complete and log.summary["seconds"] > 0:
            rate = log.summary["events"] / log.summary["seconds"]
        shown = _view(log, status(log), rate, console.width)
    console.print(shown)


def _view(log: "Log", seen: "Status", rate: float | None, width: int) -> "Group":
    from rich.console import Group

    from idealgas.presentation.tables import format_estimate

    rows = {
        "time": f"{seen.time:.6g}",
        "events": f"{seen.events:,}",
        "events per second": "-" if rate is None else f"{rate:,.0f}",
        "temperature": f"{seen.temperature:.6g}",
    }
    for name, estimate in (("pressure", seen.pressure), ("Z = PA/NT", seen.compressibility_factor)):
        rows[name] = "-" if estimate is None else format_estimate(replace(estimate, theory=None))
    rows["KS distance of speeds"] = "-" if seen.ks_distance is None else f"{seen.ks_distance:.4f}"
    table = as_rich(facts(f"{log.path}: {log.run_state}", rows), width)
    return Group(*(f"caveat: {sentence}" for sentence in seen.caveats), *table, _histogram(seen))


def _histogram(seen: "Status") -> str:
    """Return a text histogram of the speeds; a mark on each line shows the Maxwell-Boltzmann density."""
    from idealgas.presentation.tables import bars

    if seen.density is None:
        return "nothing moves"
    law = "speeds in units of √(T/m); │ Maxwell-Boltzmann"
    return f"{law}\n{bars(seen.edges[:-1].tolist(), seen.density.tolist(), seen.expected.tolist())}"
