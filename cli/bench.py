"""Command `idealgas bench`: measure the speed of the engine on this machine."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from idealgas.files import check_output

from ._options import force_option, json_option, plot_option
from ._tables import print_tables, shown
from ._terminal import data, echo, terminal, written

if TYPE_CHECKING:
    from idealgas.bench.bench import Bench


def _numbers(_context: click.Context, _parameter: click.Parameter, text: str) -> list[float]:
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        raise click.BadParameter(f"not numbers separated by commas (got {text!r})") from None


@click.command(epilog="Example: idealgas bench --number 1000 --phi 0.1,0.5")
@click.option(
    "--number", "numbers", default="1e3,1e4,1e5", show_default=True, callback=_numbers, help="Numbers of discs N."
)
@click.option(
    "--phi", "fractions", default="0.01,0.1,0.5", show_default=True, callback=_numbers, help="Packing fractions φ."
)
@click.option(
    "--collisions", type=click.IntRange(1), default=1_000_000, show_default=True,
    help="Smallest number of pair collisions in a run.",
)  # fmt: skip
@click.option(
    "--repeats", type=click.IntRange(1), default=3, show_default=True,
    help="Number of runs of each kind; the median is shown.",
)  # fmt: skip
@click.option("--threads", default="1", show_default=True, callback=_numbers, help="Numbers of threads.")
@click.option("--effects", is_flag=True, help="Measure instead what each effect costs, relative to a plain box.")
@plot_option
@force_option
@json_option
def bench(
    numbers: list[float],
    fractions: list[float],
    collisions: int,
    repeats: int,
    threads: list[float],
    effects: bool,
    plot: str | None,
    force: bool,
    as_json: bool,
) -> None:
    """Measure the speed of the event-driven engine for several N and φ, with and without the event log.

    The figure also shows reported speeds of other programs.
    """
    if min(numbers) < 1 or not all(0 < phi <= 0.9 for phi in fractions):
        raise click.UsageError("N must be at least 1, φ above 0 and at most 0.9")
    if not all(1 <= number <= 256 for number in threads):
        raise click.UsageError("the number of threads must be 1 to 256")
    if plot and effects:
        raise click.UsageError("--plot cannot be combined with --effects")
    if plot:
        check_output(plot, Path(plot).suffix.lower(), force)
    if effects:
        _bench_effects(collisions, repeats, as_json)
        return
    result = _measure([int(n) for n in numbers], fractions, [int(number) for number in threads], collisions, repeats)
    if plot:
        from idealgas.bench.figure import bench_figure
        from idealgas.presentation.style import save

        save(bench_figure(result), plot, force)
    _show(result, as_json)
    if plot:
        written(plot, err=as_json)


def _measure(numbers: list[int], fractions: list[float], threads: list[int], collisions: int, repeats: int) -> "Bench":
    from idealgas.bench.bench import bench as measure

    console = terminal(err=True)
    with console.status("compiling") as status:
        return measure(
            numbers,
            fractions,
            collisions,
            repeats,
            lambda row: status.update(f"N = {row.N}, φ = {row.phi:g}: {row.collisions_per_s:,.0f} collisions/s"),
            threads,
        )


def _show(result: "Bench", as_json: bool) -> None:
    from idealgas.presentation.tables import Number, Table

    if as_json:
        rows = [row._asdict() for row in result.rows]
        data(json.dumps({"compile_seconds": result.compile_seconds, "rows": rows}, indent=2))
        return
    cells = [
        (
            Number(row.N, ",d"),
            Number(row.phi, "g"),
            Number(row.threads, "d"),
            "on" if row.log else "off",
            Number(row.collisions_per_s / 1e6, ".3f"),
            shown(f"{row.slowest / 1e6:.3f} – {row.fastest / 1e6:.3f}"),
            Number(row.ratio, ".2f"),
        )
        for row in result.rows
    ]
    heads = ("N", "φ", "threads", "log", "M collisions/s", "slowest – fastest", "log / no log")
    print_tables([Table("", heads, cells)])
    echo(f"compilation or loading of the machine code: {result.compile_seconds:.2f} s, not included above")


def _bench_effects(events: int, repeats: int, as_json: bool) -> None:
    from idealgas.bench.effects import bench_effects
    from idealgas.presentation.tables import Number, Table

    console = terminal(err=True)
    with console.status("compiling") as status:
        rows = bench_effects(events, repeats, lambda row: status.update(f"{row.effect}: {row.ratio:.2f}"))
    if as_json:
        data(json.dumps({"rows": [row._asdict() for row in rows]}, indent=2))
        return
    cells = [
        (
            row.effect,
            Number(row.ratio, ".2f"),
            shown(f"{row.smallest:.2f} – {row.largest:.2f}"),
            Number(row.compile_seconds, ".1f"),
        )
        for row in rows
    ]
    heads = ("effect", "time per event / plain box", "smallest – largest", "compiling or loading, s")
    print_tables([Table("", heads, cells)])
