"""Functions shared by commands that read a log, and the commands of the analyses, built from the registry."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from idealgas.analysis import registry
from idealgas.errors import NotApplicableError, UserError
from idealgas.files import check_output

from ._options import FILE, force_option, json_option, plot_errors_option, plot_option, points_option, quiet_option
from ._progress import progress_bar
from ._tables import print_tables, write_columns
from ._terminal import data, echo, written

if TYPE_CHECKING:
    from idealgas.analysis.analysis import Analysis, Option
    from idealgas.log import Log


def log_argument(command: Callable) -> Callable:
    """Add the argument `RUN.h5`, the path of a log, as `path`."""
    return click.argument("path", type=FILE, metavar="RUN.h5")(command)


def open_log(path: str) -> "Log":
    """Open a log for reading, and print a notice to stderr if the log was not closed."""
    from idealgas import log

    opened = log.open_log(path)
    if opened.unclosed:
        state = "is being written" if opened.live else "was not closed (crash?); continue it with `idealgas resume`"
        echo(f"{path}: {state}; read up to t = {opened.end_time:g}, {len(opened):,} event rows", err=True)
    return opened


def print_json(result: dict[str, Any]) -> None:
    """Print a result as JSON."""
    import json

    data(json.dumps(result, indent=2, allow_nan=False))


# ── commands of the analyses ──


class AnalysisCommand(click.Command):
    """Command of an analysis: it takes logs, the options of the analysis, and options common to all analyses.

    The help text is the docstring of the analysis module, which is imported only when its options are needed.
    """

    def __init__(self, name: str) -> None:
        example = f"Example: idealgas {name} gas.h5 --plot {name}.png"
        super().__init__(name, help=registry.help_of(name.replace("-", "_")), epilog=example, callback=self._call)

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """Return the parameters of the command."""
        if not self.params:
            self.params = _parameters(self._analysis)
        return super().get_params(ctx)

    @property
    def _analysis(self) -> "type[Analysis]":
        return registry.find(self.name or "")

    def _call(self, **arguments: Any) -> None:
        _analyse(self._analysis, **arguments)


def _parameters(analysis: "type[Analysis]") -> list[click.Parameter]:
    def command() -> None:
        pass

    decorators = [_logs(analysis), *map(_option, analysis.options), *_common_options(analysis)]
    for decorate in reversed(decorators):
        command = decorate(command)
    return click.command()(command).params


def _logs(analysis: "type[Analysis]") -> Callable:
    if analysis.combine is None:
        return click.argument("paths", type=FILE, metavar="RUN.h5", callback=lambda _, __, path: (path,))
    return click.argument("paths", type=FILE, metavar="RUN.h5|DIR...", nargs=-1, required=True)


def _option(option: "Option") -> Callable:
    """Return the command-line option for an option of an analysis."""
    kind: Any = option.kind
    if option.choices:
        kind = click.Choice(option.choices)
    elif option.positive:
        kind = click.FloatRange(min=0, min_open=True)
    elif option.least is not None or option.most is not None:
        bounds: Any = click.IntRange if option.kind is int else click.FloatRange
        kind = bounds(option.least, option.most)
    return click.option(
        f"--{option.name.replace('_', '-')}", option.name, type=kind, default=option.default, help=option.help,
        show_default=option.default is not None, metavar=option.metavar,
    )  # fmt: skip


def _common_options(analysis: "type[Analysis]") -> Iterator[Callable]:
    for name, variable, where, default in (
        ("--from", "start", "Start", analysis.start), ("--to", "end", "End", analysis.end),
    ):  # fmt: skip
        words = f"{where} of the window, in simulated time.  [default: {default}]"
        yield click.option(name, variable, type=float, metavar="T", help=words)
    yield plot_option
    yield plot_errors_option
    if hasattr(analysis.results[0], "rows"):
        yield points_option
    yield force_option
    yield json_option
    yield quiet_option
    words = "Print all numbers as CSV with all digits, one row for each quantity."
    yield click.option("--csv", "as_csv", is_flag=True, help=words)
    if analysis.is_checked():
        words = (
            "Exit with code 1 if measurement and theory differ by more than chance allows, with 2 if there are too few "
            "samples to decide, and with 0 if they agree or theory is not available."
        )
        yield click.option("--check", is_flag=True, help=words)


def _analyse(
    analysis: "type[Analysis]",
    paths: tuple[str, ...],
    start: float | None,
    end: float | None,
    plot: str | None,
    plot_errors: str | None,
    force: bool,
    as_json: bool,
    as_csv: bool,
    check: bool = False,
    points: str | None = None,
    **options: Any,
) -> None:
    """Analyse logs, and print or draw the result in the requested form."""
    if as_json and as_csv:
        raise UserError("--csv and --json cannot be combined")
    drawn = [path for path in (plot, plot_errors) if path]
    files = [path for path in (*drawn, points) if path]
    for path in files:
        check_output(path, Path(path).suffix.lower(), force, paths)
    try:
        with progress_bar(f"reading {analysis.reads}") as progress:
            results = [result for path in paths for result in _results(analysis, path, start, end, progress, options)]
        result = analysis.combined(results)
    except NotApplicableError as error:
        if not check or files or as_csv:
            raise
        from idealgas.analysis.check import CheckResult

        inapplicable = CheckResult(reason=str(error))
        if as_json:
            print_json(inapplicable.as_dict())
        else:
            echo(f"{inapplicable}", err=True)
        return
    checked = result.check() if check else None
    missing = {path: sentence for path in paths if (sentence := _missing(path))}
    for path, sentence in missing.items():
        echo(f"{path}: {sentence}", err=True)
    for path in drawn:
        from idealgas.presentation.style import add_title, save

        figure = result.plot() if path == plot else result.plot_errors()
        if missing:
            add_title(figure, ". ".join([*missing.values(), figure.get_suptitle()]))
        save(figure, path, force)
    if points:
        write_columns(result.rows(), points, force)
    if as_json:
        unchecked = {"agrees": None} if analysis.is_checked() else {}
        print_json(result.as_dict() | (checked.as_dict() if checked else unchecked))
    elif as_csv:
        from idealgas.presentation.quantities import as_csv as csv_of

        for sentence in result.caveats:
            echo(f"caveat: {sentence}", err=True)
        data(csv_of(result.as_dict(), analysis.name), nl=False)
    else:
        if headline := result.summary():
            echo(headline)
        print_tables(result.tables())
        if text := result.text():
            echo(text)
        if checked:
            print_tables(checked.tables())
            echo(f"{checked}", err=not checked.compared)
    for path in files:
        written(path, err=as_json or as_csv)
    if checked and checked.compared and not checked.agrees:
        raise SystemExit(1 if checked.agrees is False else 2)


def _results(
    analysis: "type[Analysis]",
    path: str,
    start: float | None,
    end: float | None,
    progress: Callable[[int, int], None],
    options: dict[str, Any],
) -> Iterator[Any]:
    """Yield the result of a log, or the stored results of all points if the path is the folder of a sweep."""
    if analysis.combine and os.path.isdir(path):
        from idealgas.sweep.results import stored_results

        for values, origin in stored_results(path, analysis.key):
            yield analysis.restored(values, origin)
        return
    with open_log(path) as log:
        yield analysis.analyse(log, start, end, progress, **options)


def _missing(path: str) -> str:
    """Return a sentence about the runs missing from a sweep's folder; empty for a complete sweep or a log."""
    if not os.path.isdir(path):
        return ""
    from idealgas.sweep.results import missing_runs

    missing, total = missing_runs(path)
    return f"{missing:,} of {total:,} runs are missing" if missing else ""
