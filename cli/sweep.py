"""Command `idealgas sweep`: run a scene for many parameter values, on this machine or on a cluster."""

import json
import os
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from idealgas.errors import UserError
from idealgas.files import check_output

from ._options import FILE, force_option, json_option, overrides_option, plot_option, quiet_option
from ._progress import progress_bar
from ._tables import print_tables, shown
from ._terminal import data, echo, written

if TYPE_CHECKING:
    from idealgas.sweep.plan import Sweep
    from idealgas.sweep.run import SweepProgress


EXAMPLE = """\b
A sweep of the scene gas.toml, in the file temperatures.toml:
  [sweep]
  scene = "gas.toml"
  analyses = ["pressure"]
  [[axis]]
  key = "species.gas.temperature"
  values = [0.5, 1, 2, 4]

Example: idealgas sweep temperatures.toml -o temperatures --plot pressure.png"""


@click.command(epilog=EXAMPLE)
@click.argument("paths", type=FILE, metavar="SWEEP.toml...", nargs=-1)
@click.option(
    "-o", "--output", type=FILE, metavar="DIR",
    help="Folder for logs and results; several sweeps get a subfolder each, and an existing sweep is continued.",
)  # fmt: skip
@click.option(
    "--workers", type=click.IntRange(1), metavar="N",
    help="Number of processes on this machine.  [default: one per core]",
)  # fmt: skip
@overrides_option(" Keys of the tables in SWEEP.toml (sweep.replicates=2) can also be changed.")
@click.option("--scheduler", metavar="ADDRESS", help="Address of a dask scheduler whose workers run the points.")
@click.option("--dry-run", is_flag=True, help="Only list the points and estimate the cost (time and disk space).")
@plot_option
@click.option(
    "--of", "quantity", metavar="QUANTITY",
    help="Quantity to plot, as named in results.csv.  [default: deviations from published values if there are any, "
    "otherwise the main quantity of the first analysis]",
)  # fmt: skip
@click.option("--against", "axis", metavar="KEY", help="Axis to plot against.  [default: the first axis]")
@click.option("--list", "listing", is_flag=True, help="List the quantities of all analyses; * stands for any group.")
@force_option
@json_option
@quiet_option
def sweep(
    paths: tuple[str, ...],
    output: str | None,
    workers: int | None,
    overrides: tuple[str, ...],
    scheduler: str | None,
    dry_run: bool,
    plot: str | None,
    quantity: str | None,
    axis: str | None,
    listing: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Run a scene for many parameter values (points) and collect the results in DIR/results.csv.

    To continue a sweep that was stopped, run the same command again; finished points are not repeated. A point that
    fails is tried twice more and then reported, while the other points continue. With --plot, a figure is drawn at the
    end.
    """
    if listing:
        _list_quantities()
        return
    if not paths:
        raise UserError("SWEEP.toml: missing (the file of the sweep)")
    from idealgas.sweep.plan import load_sweep
    from idealgas.sweep.run import require_dask

    require_dask()
    with progress_bar("checking the points") as show:
        plans = [load_sweep(path, overrides, show) for path in paths]
    if dry_run:
        planned = [_planned(path, plan, workers, as_json) for path, plan in zip(paths, plans, strict=True)]
        _print_json(planned, as_json)
        return
    if output is None:
        raise UserError("-o DIR: missing (the folder for logs and results)")
    folders = _folders(paths, output)
    compares = all(plan.published for plan in plans) and not quantity and not axis
    if plot:
        check_output(plot, Path(plot).suffix.lower(), force, paths)
        if len(plans) > 1 and not compares:
            raise UserError("--plot: several sweeps can only be plotted together against published values")
    from ._interrupt import stop_signals

    outcomes: list[dict[str, Any]] = []
    with stop_signals(raises=True) as interrupted:
        try:
            for plan, folder in zip(plans, folders, strict=True):
                outcomes.append(_run(plan, folder, workers, scheduler, interrupted, as_json))
        except BaseException:
            if not interrupted():  # after an interruption, libraries may raise any error
                raise
        if interrupted():
            echo("interrupted; run the same command again to continue", err=True)
            raise SystemExit(interrupted())
    _print_json(outcomes, as_json)
    if plot:
        from idealgas.presentation.style import save
        from idealgas.sweep.figure import sweep_figure
        from idealgas.sweep.published import published_figure

        sweeps = zip(plans, folders, strict=True)
        save(published_figure(sweeps) if compares else sweep_figure(output, quantity, axis), plot, force)
        written(plot, err=as_json)
    if any(outcome["failures"] for outcome in outcomes):
        raise SystemExit(1)


def _folders(paths: tuple[str, ...], output: str) -> list[str]:
    """Return the folder of each sweep: the output folder itself for a single sweep, otherwise named subfolders."""
    if len(paths) == 1:
        return [output]
    names = [Path(path).stem for path in paths]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise UserError(f"{twice}: two sweeps have this name, and so the same folder; rename one of the files")
    return [str(Path(output) / name) for name in names]


def _print_json(results: list[dict[str, Any]], as_json: bool) -> None:
    """If JSON is requested, print the result of a single sweep, or the list of results of several sweeps."""
    if as_json:
        data(json.dumps(results[0] if len(results) == 1 else results, indent=2, allow_nan=False))


def _run(
    plan: "Sweep",
    output: str,
    workers: int | None,
    scheduler: str | None,
    interrupted: Callable[[], int],
    as_json: bool,
) -> dict[str, Any]:
    """Run a sweep, print its outcome unless JSON is requested, and return the outcome as plain values."""
    from idealgas.sweep.published import published_tables
    from idealgas.sweep.results import result_rows
    from idealgas.sweep.run import run_sweep

    with progress_bar("sweep") as show:

        def on_progress(progress: "SweepProgress") -> None:
            done = progress.done + progress.failed
            show(done, progress.total, f"{done}/{progress.total} points, {progress.failed} failed")
            if interrupted():  # a library may have swallowed the exception
                raise KeyboardInterrupt

        def on_estimate(done: int, total: int) -> None:
            show(done, total, "estimating the time from short runs")

        outcome = run_sweep(
            plan, output, workers=workers, scheduler=scheduler, on_progress=on_progress, on_estimate=on_estimate
        )
    for index, reason in outcome.failures.items():
        echo(f"point {index} failed: {reason}", err=True)
    for notice in outcome.notices:
        echo(notice, err=True)
    if as_json:
        return {**asdict(outcome), "results": result_rows(output) if outcome.files else []}
    if outcome.files:
        done = f"{outcome.ran} points run, {outcome.before} done before, {len(outcome.failures)} failed"
        estimate = "" if outcome.estimated is None else f" (estimate {outcome.estimated:.3g} s)"
        echo(f"{done}: {' and '.join(outcome.files)}")
        if outcome.ran:
            echo(f"time: {outcome.seconds:.3g} s{estimate}")
        print_tables(published_tables(plan, output))
    return asdict(outcome)


def _list_quantities() -> None:
    from idealgas.analysis import registry
    from idealgas.presentation.quantities import names

    for analysis in registry.analyses():
        data("\n".join(names(analysis.results[0], (analysis.name,))))


def _planned(path: str, plan: "Sweep", workers: int | None, as_json: bool) -> dict[str, Any]:
    """Print the points of a sweep and their cost unless JSON is requested, and return them as plain values."""
    from rich.filesize import decimal

    from idealgas.presentation.tables import Cell, Number, Table
    from idealgas.sweep.cost import estimate_cost, total_seconds

    workers = workers or os.cpu_count() or 1
    with progress_bar("estimating the cost from short runs") as show:
        costs = estimate_cost(plan, show)
    seconds = total_seconds(costs, workers)
    labels = ({"point": p.index, "replicate": p.replicate, "values": p.values} for p in plan.points)
    points = [label | cost._asdict() for label, cost in zip(labels, costs, strict=True)]
    result = {"points": points, "workers": workers, "seconds": seconds}
    if as_json:
        return result
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
    echo(f"{path}: {len(plan.points)} points, about {seconds:.3g} s on {workers} workers, disk: {kept}")
    return result
