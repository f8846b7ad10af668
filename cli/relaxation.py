"""`idealgas relaxation`: how does a gas come to equilibrium?"""

from typing import TYPE_CHECKING

import click

from ._analysis import open_log, plot_option, print_json, reading
from ._options import json_option

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np

    from idealgas.analysis.core.statistics import Estimate
    from idealgas.analysis.relaxation.acceptance import Acceptance
    from idealgas.analysis.relaxation.measure import Relaxation
    from idealgas.analysis.relaxation.speeds import SpeedDistributions


@click.command()
@click.argument("paths", metavar="RUN.h5...", nargs=-1, required=True)
@click.option("--from", "start", type=float, metavar="T", help="Start, time.  [default: the log's start]")
@click.option("--to", "end", type=float, metavar="T", help="End, time.  [default: after 40 collisions per disc]")
@click.option(
    "--every", type=click.FloatRange(min=0, min_open=True), metavar="X",
    help="Also show the speeds every so many trials of a Monte Carlo run, or units of time of any other.",
)  # fmt: skip
@plot_option
@json_option
def relaxation(
    paths: tuple[str, ...],
    start: float | None,
    end: float | None,
    every: float | None,
    plot: str | None,
    as_json: bool,
) -> None:
    """Measure how the velocities come to follow Maxwell and Boltzmann.

    The relaxation time is that of an exponential fitted to the kurtosis of the velocities; its error comes from groups
    of discs. Several logs lie on one plot.
    """
    from idealgas.analysis.relaxation.acceptance import acceptance
    from idealgas.analysis.relaxation.measure import relaxation as measure
    from idealgas.analysis.relaxation.speeds import speed_distributions

    results, tables, tried = [], [], []
    with reading("instants") as progress:
        for path in paths:
            with open_log(path) as log:
                results.append(measure(log, start, end, progress))
                tables.append(None if every is None else speed_distributions(log, every, start, end))
                tried.append(acceptance(log))
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.analysis.relaxation.figure import relaxation_figure

        save(relaxation_figure(results), plot)
    if as_json:
        rows = zip(results, tables, tried, strict=True)
        print_json(
            {
                "logs": [
                    result.as_dict()
                    | {"acceptance": attempts and attempts.as_dict(), "speed_distributions": table and table.as_dict()}
                    for result, table, attempts in rows
                ]
            }
        )
        return
    for result, table in zip(results, tables, strict=True):
        if table is not None:
            _print_development(result.path, table)
    _print(results)
    for result, attempts in zip(results, tried, strict=True):
        if attempts is not None:
            _print_trials(result.path, attempts)


def _print(results: "Sequence[Relaxation]") -> None:
    from rich.console import Console
    from rich.table import Table

    from idealgas.analysis.relaxation.measure import LINEAR, SETTLED

    table = Table("", title="Relaxation to Maxwell-Boltzmann", title_justify="left")
    for head in ("N", "relaxation time", "settled", "not told apart"):
        table.add_column(head, justify="right")
    for r in results:
        settled = f"{SETTLED * r.in_time.value:.4g}" if r.in_time else ""
        table.add_row(r.path, f"{r.number}", _fitted(r.in_time), settled, _told(r, r.time - r.time[0]))
        table.add_row("  collisions per disc", "", _fitted(r.in_collisions), "", _told(r, r.collisions))
    Console().print(table)
    click.echo(
        "Relaxation time: of the kurtosis; after three of them 5 % of the distance is left, and the gas has settled.\n"
        "Not told apart: the first time that the speeds pass a Kolmogorov-Smirnov test at 5 %.\n"
        "A collision counts for both discs. Near equilibrium theory expects a relaxation time of "
        f"{LINEAR:g} collisions\nper disc, farther away more."
    )


def _fitted(found: "Estimate | None") -> str:
    return "none seen" if found is None else f"{found.value:.4g} ± {found.standard_error:.2g}"


def _told(result: "Relaxation", series: "np.ndarray") -> str:
    return "not reached" if result.first_indistinguishable is None else f"{series[result.first_indistinguishable]:.3g}"


def _print_trials(path: str, tried: "Acceptance") -> None:
    """Acceptance beside theory and, for the classic run, beside what was published."""
    share = tried.acceptance
    click.echo(
        f"{path}: {tried.collisions:,} collisions in {tried.number:,} trials, {tried.collisions_per_disc:.1f} per disc "
        f"({tried.collisions_per_disc / 2:.1f} if each is counted once)"
    )
    click.echo(f"acceptance {share.value:.4f} ± {share.standard_error:.4f}; theory {tried.at_start:.4f} at the start")
    for name, expected in tried.expected.items():
        click.echo(f"  in equilibrium {expected:.4f}, {expected * tried.number:,.0f} collisions: {name}")
    if tried.published is not None:
        share_published = tried.published / tried.number
        click.echo(f"  published {share_published:.4f}, {tried.published:,} collisions: Novak & Bortz (1970)")


def _print_development(path: str, found: "SpeedDistributions") -> None:
    """Counts of discs by speed, one row an instant, Maxwell and Boltzmann's last."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    title = f"{path}: discs by speed, in classes from multiples of {found.rms:.4g} (rms)"
    table = Table(title=title, title_justify="left", box=box.SIMPLE, padding=(0, 1, 0, 0))
    classes = (f"{edge / found.rms:.1f}" for edge in found.edges)
    for head in ("time" if found.trials is None else "trials", "coll/disc", "KS", *classes):
        table.add_column(head, justify="right")
    for k, time in enumerate(found.time):
        clock = f"{time:.4g}" if found.trials is None else f"{found.trials[k]:,}"
        row = (clock, f"{found.collisions[k]:.2f}", f"{found.distance[k]:.3f}", *map(str, found.counts[k]))
        table.add_row(*row, end_section=k + 1 == len(found.time))
    table.add_row("law", "", "", *(f"{number:.1f}" for number in found.expected))
    Console().print(table)
