"""Command `idealgas bench`: speed of the engine on this machine."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from idealgas.files import check_output

from ._options import force_option, json_option, plot_option
from ._terminal import echo, terminal

if TYPE_CHECKING:
    from idealgas.study.bench.bench import Bench


def _numbers(_context: click.Context, _parameter: click.Parameter, text: str) -> list[float]:
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        raise click.BadParameter(f"numbers with commas between them (got {text!r})") from None


@click.command()
@click.option(
    "--number", "numbers", default="1e3,1e4,1e5", show_default=True, callback=_numbers, help="Numbers of discs N."
)
@click.option(
    "--phi", "fractions", default="0.01,0.1,0.5", show_default=True, callback=_numbers, help="Packing fractions φ."
)
@click.option("--collisions", default=1_000_000, show_default=True, help="Smallest number of pair collisions of a run.")
@click.option("--repeats", default=3, show_default=True, help="Number of runs of each kind; the median is shown.")
@click.option("--threads", default="1", show_default=True, callback=_numbers, help="Numbers of threads.")
@click.option("--effects", is_flag=True, help="Measure instead the cost of each effect, relative to the plain box.")
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
    """Measure the speed of the event-driven engine for several N and φ, without the event log and with it.

    The picture also has the speed of other programs, as it was stated.
    """
    if min(numbers) < 1 or not all(0 < phi <= 0.9 for phi in fractions) or collisions < 1 or repeats < 1:
        raise click.UsageError("N, collisions and repeats are 1 or more, φ is above 0 and 0.9 at most")
    if not all(1 <= number <= 256 for number in threads):
        raise click.UsageError("there are 1 to 256 threads")
    if plot and effects:
        raise click.UsageError("--plot is not for --effects")
    if plot:
        check_output(plot, Path(plot).suffix.lower(), force)
    if effects:
        _bench_effects(collisions, repeats, as_json)
        return
    found = _measure([int(n) for n in numbers], fractions, [int(number) for number in threads], collisions, repeats)
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.study.bench.figure import bench_figure

        save(bench_figure(found), plot, force)
    _show(found, as_json)


def _measure(numbers: list[int], fractions: list[float], threads: list[int], collisions: int, repeats: int) -> "Bench":
    from idealgas.study.bench.bench import bench as measure

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


def _show(found: "Bench", as_json: bool) -> None:
    import json

    from rich.table import Table

    if as_json:
        rows = [row._asdict() for row in found.rows]
        echo(json.dumps({"compile_seconds": found.compile_seconds, "rows": rows}, indent=2))
        return
    table = Table("N", "φ", "threads", "log", "M collisions/s", "slowest – fastest", "log / no log")
    for row in found.rows:
        share = "" if row.ratio is None else f"{row.ratio:.2f}"
        spread = f"{row.slowest / 1e6:.3f} – {row.fastest / 1e6:.3f}"
        rate = f"{row.collisions_per_s / 1e6:.3f}"
        table.add_row(f"{row.N:,}", f"{row.phi:g}", str(row.threads), "on" if row.log else "off", rate, spread, share)
    terminal().print(table)
    echo(f"compilation or loading of the machine code: {found.compile_seconds:.2f} s, not counted above")


def _bench_effects(events: int, repeats: int, as_json: bool) -> None:
    import json

    from rich.table import Table

    from idealgas.study.bench.effects import bench_effects

    console = terminal(err=True)
    with console.status("compiling") as status:
        rows = bench_effects(events, repeats, lambda row: status.update(f"{row.effect}: {row.ratio:.2f}"))
    if as_json:
        echo(json.dumps({"rows": [row._asdict() for row in rows]}, indent=2))
        return
    table = Table("effect", "time per event / plain box", "smallest – largest", "compiling or loading, s")
    for row in rows:
        spread = f"{row.smallest:.2f} – {row.largest:.2f}"
        table.add_row(row.effect, f"{row.ratio:.2f}", spread, f"{row.compile_seconds:.1f}")
    terminal().print(table)
