"""`idealgas evolution`: what becomes of temperature and energy with time?"""

from typing import TYPE_CHECKING

import click

from ._analysis import log_argument, open_log, plot_option, print_json
from ._options import json_option

if TYPE_CHECKING:
    from idealgas.analysis.evolution.measure import Evolution

ROWS = 9


@click.command()
@log_argument
@click.option("--from", "start", type=float, metavar="T", help="First time shown.  [default: the log's start]")
@click.option("--to", "end", type=float, metavar="T", help="Last time shown.  [default: the log's end]")
@plot_option
@json_option
def evolution(path: str, start: float | None, end: float | None, plot: str | None, as_json: bool) -> None:
    """Follow temperature, discs beyond a gate, piston and energy account in time, with the law of the temperature.

    Laws: Haff's for a gas that cools, the adiabat of a slow piston, the place of a piston under pressure, and
    equilibrium for isolated gases, columns under gravity and heat baths.
    """
    from idealgas.analysis.evolution.measure import evolution as follow

    with open_log(path) as log:
        result = follow(log, start, end)
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.analysis.evolution.figure import evolution_figure

        save(evolution_figure(result), plot)
    if as_json:
        print_json(result.as_dict())
        return
    click.echo(f"law: {result.law.text if result.law else 'none for this scene'}")
    _print_course(result)
    _print_account(result)


def _print_course(result: "Evolution") -> None:
    columns = {"t": result.time, "m v²/2 a disc": result.temperature}
    if result.law is not None:
        columns["law"] = result.law.temperature
    if result.spin is not None:
        columns["I ω² a disc"] = result.spin
    columns |= {f"{name} beyond the gate": share for name, share in result.beyond.items()}
    _print_table("Course in time", columns)


def _print_account(result: "Evolution") -> None:
    columns = {"t": result.samples} | {f"energy of {name}": values for name, values in result.parts.items()}
    columns |= {f"given by {name}": values for name, values in result.given.items()}
    if result.piston is not None:
        columns["piston at"] = result.piston
    _print_table("Energy", columns | {"balance, relative": result.balance})


def _print_table(title: str, columns: dict) -> None:
    """ROWS of them, evenly taken."""
    from rich.console import Console
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for head in columns:
        table.add_column(head, justify="right")
    last = len(columns["t"]) - 1
    for row in sorted({round(last * k / (ROWS - 1)) for k in range(ROWS)}) if last >= 0 else ():
        table.add_row(*(f"{values[row]:.6g}" for values in columns.values()))
    Console().print(table)
