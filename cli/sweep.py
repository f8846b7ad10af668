"""Command `idealgas sweep`: many runs of a scene, on this machine or on a cluster."""

import os
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from idealgas.errors import UserError
from idealgas.files import check_output

from ._analysis import print_json
from ._options import FILE, force_option, json_option, plot_option, quiet_option
from ._progress import progress_bar
from ._tables import print_tables, shown
from ._terminal import data, echo, written

if TYPE_CHECKING:
    from idealgas.sweep.plan import Sweep
    from idealgas.sweep.run import Progress


@click.command(epilog="Example: idealgas sweep phi.toml -o phi --workers 2")
@click.argument("path", type=FILE, metavar="SWEEP.toml", required=False)
@click.option(
    "-o", "--output", type=FILE, metavar="DIR", help="Folder for logs and results; an existing one is continued."
)
@click.option(
    "--workers", type=click.IntRange(1), metavar="N", help="Number of processes on this machine.  [default: its cores]"
)
@click.option("--scheduler", metavar="ADDRESS", help="Address of a dask scheduler whose workers run the points.")
@click.option("--dry-run", is_flag=True, help="Show the points and a cost estimate (time and disk space); run nothing.")
@plot_option
@click.option(
    "--of", "quantity", metavar="QUANTITY",
    help="Quantity to plot, by its name in results.csv.  [default: the main one of the first analysis]",
)  # fmt: skip
@click.option("--against", "axis", metavar="KEY", help="Axis to plot against.  [default: the first one]")
@click.option("--list", "listing", is_flag=True, help="List the quantities of all analyses; * stands for any group.")
@force_option
@json_option
@quiet_option
def sweep(
    path: str | None,
    output: str | None,
    workers: int | None,
    scheduler: str | None,
    dry_run: bool,
    plot: str | None,
    quantity: str | None,
    axis: str | None,
    listing: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Run a scene at many points and collect the results of its analyses in DIR/results.csv.

    The same command continues a sweep that was stopped; finished points are not run again. A point that fails is tried
    twice more and then reported; the other points run. With --plot it draws a figure at the end.
    """
    if listing:
        _list_quantities()
        return
    if path is None:
        raise UserError("SWEEP.toml: missing (the file of the sweep)")
    from idealgas.sweep.plan import load_sweep

    plan = load_sweep(path)
    if dry_run:
        _print_plan(plan, workers, as_json)
        return
    if output is None:
        raise UserError("-o DIR: missing (the folder for logs and results)")
    if plot:
        check_output(plot, Path(plot).suffix.lower(), force, [path])
    from ._interrupt import EXIT_CODE, ctrl_c

    failed = False
    with ctrl_c(raises=True) as interrupted:
        try:
            failed = _run(plan, output, workers, scheduler, interrupted, as_json)
        except BaseException:
            if not interrupted():  # otherwise an error caused by the interruption
                raise
        if interrupted():
            echo("interrupted; run the same command again to continue", err=True)
            raise SystemExit(EXIT_CODE)
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.sweep.figure import sweep_figure

        save(sweep_figure(output, quantity, axis), plot, force)
        written(plot, err=as_json)
    if failed:
        raise SystemExit(1)


def _run(
    plan: "Sweep",
    output: str,
    workers: int | None,
    scheduler: str | None,
    interrupted: Callable[[], bool],
    as_json: bool,
) -> bool:
    """Run a sweep and write its tables; return whether any point failed."""
    from idealgas.sweep.published import published_tables
    from idealgas.sweep.results import result_rows, write_tables
    from idealgas.sweep.run import run_sweep

    with progress_bar("sweep") as show:

        def on_progress(progress: "Progress") -> None:
            done = progress.done + progress.failed
            show(done, progress.total, f"{done}/{progress.total} points, {progress.failed} failed")
            if interrupted():  # a library may have swallowed the exception
                raise KeyboardInterrupt

        outcome = run_sweep(plan, output, workers=workers, scheduler=scheduler, on_progress=on_progress)
    for index, reason in outcome.failures.items():
        echo(f"point {index} failed: {reason}", err=True)
    tables = write_tables(output) if outcome.ran or outcome.before else []
    published = list(published_tables(plan, output)) if tables else []
    if as_json:
        rows = result_rows(output) if tables else []
        print_json({**asdict(outcome), "files": list(map(str, tables)), "results": rows})
    elif tables:
        done = f"{outcome.ran} points run, {outcome.before} done before, {len(outcome.failures)} failed"
        estimate = "" if outcome.estimated is None else f" (estimate {outcome.estimated:.3g} s)"
        echo(f"{done}: {' and '.join(map(str, tables))}")
        if outcome.ran:
            echo(f"time: {outcome.seconds:.3g} s{estimate}")
        print_tables(published)
    return bool(outcome.failures)


def _list_quantities() -> None:
    from idealgas.analysis import registry
    from idealgas.analysis.core.quantities import names

    for analysis in registry.analyses():
        data("\n".join(names(analysis.results[0], (analysis.name,))))


def _print_plan(plan: "Sweep", workers: int | None, as_json: bool) -> None:
    from rich.filesize import decimal

    from idealgas.analysis.core.tables import Cell, Number, Table
    from idealgas.sweep.cost import estimate_cost, total_seconds

    workers = workers or os.cpu_count() or 1
    costs = estimate_cost(plan)
    seconds = total_seconds(costs, workers)
    if as_json:
        labels = ({"point": p.index, "replicate": p.replicate, "values": p.values} for p in plan.points)
        points = [label | cost._asdict() for label, cost in zip(labels, costs, strict=True)]
        print_json({"points": points, "workers": workers, "seconds": seconds})
        return
    rows: list[tuple[Cell, ...]] = [
        (
            str(point.index),
            Number(point.replicate, "d"),
            *(shown(f"{value:.6g}" if isinstance(value, float) else str(value)) for value in point.values.values()),
            Number(cost.number, "d"),
            Number(cost.packing_fraction, ".4g"),
            Number(cost.events, ",.0f"),
            shown(decimal(int(cost.bytes))),
        )
        for point, cost in zip(plan.points, costs, strict=True)
    ]
    print_tables([Table("", ("point", "replicate", *plan.points[0].values, "N", "φ", "events", "log"), rows)])
    size = sum(cost.bytes for cost in costs)
    kept = decimal(int(size)) if plan.keep_logs else f"nothing ({decimal(int(size))} of logs written and removed)"
    echo(f"{len(plan.points)} points, about {seconds:.3g} s on {workers} workers, disk: {kept}")
