"""What the commands that analyse a log share: arguments, a progress bar, and how estimates are printed."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from idealgas.errors import UserError

from ._options import json_option

if TYPE_CHECKING:
    from idealgas.analysis.core.statistics import Estimate
    from idealgas.analysis.core.window import Window
    from idealgas.log import Log

PICTURES = (".png", ".pdf", ".svg")


def log_argument(command: Callable) -> Callable:
    """`RUN.h5` as `path`."""
    return click.argument("path", metavar="RUN.h5")(command)


def open_log(path: str) -> "Log":
    """A log to read from; tells of one that was not closed, in one line."""
    from idealgas import log

    opened = log.open_log(path)
    if opened.unclosed:
        state = "is being written" if opened.live else "its writer died; `idealgas resume` would go on with it"
        click.echo(f"{path}: {state}; read up to t = {opened.end_time:g}, {len(opened):,} event rows", err=True)
    return opened


def _check_ending(_: click.Context, __: click.Parameter, value: str | None) -> str | None:
    if value is not None and not value.lower().endswith(PICTURES):
        raise UserError(f"{value}: unknown kind of picture (allowed: {', '.join(PICTURES)})")
    return value


plot_option = click.option(
    "--plot", metavar="FILE.png", callback=_check_ending, help="Draw a picture (.png, .pdf or .svg)."
)


def analysis_options(command: Callable) -> Callable:
    """`--from T --to T --plot FILE.png --json` as `start`, `end`, `plot` and `as_json`."""
    end = click.option(
        "--to", "end", type=float, metavar="T", help="End of the window, time.  [default: the log's end]"
    )
    start = click.option(
        "--from", "start", type=float, metavar="T", help="Start of the window, time.  [default: detected equilibrium]"
    )
    return start(end(plot_option(json_option(command))))


@contextmanager
def reading(what: str = "events") -> Iterator[Callable[[int, int], None]]:
    """Yield progress(done, in all) of what is read, shown as a bar on a terminal and nowhere else."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, disable=not console.is_terminal, transient=True) as bar:
        task = bar.add_task(f"reading {what}", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def print_json(result: dict[str, Any]) -> None:
    """Print a result for machines."""
    import json

    click.echo(json.dumps(result, indent=2, allow_nan=False))


def describe(window: "Window") -> str:
    """One line on the window that was used."""
    how = "from detected equilibrium" if window.detected else "as asked"
    return f"window: t = {window.start:.6g} to {window.end:.6g} ({how})"


ESTIMATE_HEADS = ("value", "± s.e.", "samples", "theory", "dev./s.e.")


def cells(estimate: "Estimate") -> tuple[str, ...]:
    """An estimate under ESTIMATE_HEADS."""
    theory = "" if estimate.theory is None else f"{estimate.theory:.6g}"
    deviation = "" if estimate.deviation is None else f"{estimate.deviation:+.2f}"
    samples = f"{estimate.independent_samples:.0f}"
    return f"{estimate.value:.6g}", f"{estimate.standard_error:.2g}", samples, theory, deviation


def print_estimates(title: str, rows: "list[tuple[str, Estimate]]") -> None:
    """A table of named estimates."""
    from rich.console import Console
    from rich.table import Table

    table = Table("", title=title, title_justify="left")
    for head in ESTIMATE_HEADS:
        table.add_column(head, justify="right")
    for name, estimate in rows:
        table.add_row(name, *cells(estimate))
    Console().print(table)
