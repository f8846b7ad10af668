"""Command `idealgas accuracy`: measure the errors and CPU times of the methods for a scene."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from idealgas.errors import UserError

from ._analysis import print_json
from ._options import FILE, force_option, json_option, quiet_option, scene_argument
from ._progress import progress_bar
from ._tables import print_tables, shown
from ._terminal import echo, quiet, written

if TYPE_CHECKING:
    from idealgas.accuracy.orbit import OrbitStudy, Survival
    from idealgas.presentation.tables import Cell, Number


@click.command(epilog="Example: idealgas accuracy gas.toml -o accuracy")
@scene_argument
@click.option(
    "-o", "--output", type=FILE, metavar="DIR", help="Folder for a table (CSV), all numbers (JSON) and figures (PNG)."
)
@click.option("--repeats", type=click.IntRange(1), default=3, show_default=True, help="Number of timed runs per case.")
@force_option
@json_option
@quiet_option
def accuracy(
    path: str, overrides: tuple[str, ...], output: str | None, repeats: int, force: bool, as_json: bool
) -> None:
    """Measure the errors and CPU times of the event-driven and time-driven methods and of several precisions.

    For three discs on their unstable periodic orbit (configs/three-discs.toml), measure instead how long the orbit
    lasts at each precision, in boxes of many sizes.
    """
    from idealgas.accuracy import figure as accuracy_figure
    from idealgas.accuracy import report as accuracy_report
    from idealgas.accuracy.orbit import is_on_orbit, study_orbit
    from idealgas.accuracy.study import study_accuracy
    from idealgas.initial.build import make_gas
    from idealgas.scene import load_scene

    if quiet() and output is None and not as_json:
        raise UserError("-q: requires -o or --json, otherwise the result would be lost")
    scene = load_scene(path, overrides)
    gas = make_gas(scene)
    on_orbit = not scene.effects and is_on_orbit(gas)
    name = "orbit" if on_orbit else "accuracy"
    pictures = ("",) if on_orbit else ("", "-details")
    paths = [] if output is None else accuracy_report.outputs(output, name, pictures, force)
    with progress_bar("starting") as show_progress:

        def progress(what: str, fraction: float) -> None:
            show_progress(min(fraction, 1.0), description=what)

        if on_orbit:
            orbit = study_orbit(gas, seed=scene.scene.seed, progress=progress)
        else:
            study = study_accuracy(scene, repeats, progress)
    if on_orbit:
        result = orbit.as_dict()
        rows = [{key: value for key, value in row.items() if key != "times"} for row in result["survivals"]]
        figures, show = [accuracy_figure.orbit_figure(orbit)], lambda: _print_orbit(orbit)
    else:
        result = accuracy_report.accuracy_dict(study)
        rows = [accuracy_report.flat_row(row, study) for row in study.rows]
        figures = [accuracy_figure.accuracy_figure(study), accuracy_figure.details_figure(study)]
        show = lambda: _print_rows(rows)  # noqa: E731
    if paths:
        accuracy_report.write_files(paths, result, rows, figures, force)
    if as_json:
        print_json(result)
    else:
        show()
        for sentence in result["sentences"]:
            echo(f"- {sentence}")
    for file in paths:
        written(file, err=as_json)


def _print_rows(rows: Sequence[dict[str, Any]]) -> None:
    from idealgas.presentation.tables import Table

    averages = [
        (
            row["case"],
            shown(f"{1e3 * row['cpu_s_per_time']:.3g}"),
            _number(row["cpu_s_per_collision"], "{:.3g}", 1e6),
            *(_percent(row, name) for name in ("rate_bias", "z_pairs_bias", "z_walls_bias")),
            shown(f"{_number(row['ks_distance'], '{:.3f}')}{_number(row['ks_chance'], ' ({:.3f})')}"),
        )
        for row in rows
    ]
    motion = [
        (
            row["case"],
            _number(row["missed_share"], "{:.3g}", 100),
            _number(row["deepest_overlap"], "{:.1e}"),
            _number(row["energy_drift"], "{:.1e}"),
            _number(row["trajectory_error"], "{:.1e}"),
            _number(row["trajectory_lost_after"], "{:.2g}"),
            _number(row["way_back_error"], "{:.1e}"),
        )
        for row in rows
    ]
    heads = ("", "ms/time", "µs/coll.", "rate bias %", "Z bias %, pairs", "Z bias %, walls", "KS (chance)")
    of_motion = ("", "missed %", "overlap", "energy drift", "path error", "lost after", "reversal")
    print_tables([Table("Time and averages", heads, averages), Table("The motion", of_motion, motion)])
    echo(
        "path error: distance from the double-double motion after 1 collision per disc; lost after: collisions per disc"
    )
    echo("until this distance is 0.1; reversal: distance from the start after reversing all velocities at 1 collision")
    echo("per disc. All distances are rms, in diameters.")


def _number(value: float | None, form: str, factor: float = 1.0) -> "Number":
    return shown("" if value is None else form.format(factor * value))


def _percent(row: dict[str, Any], name: str) -> "Number":
    error = row[f"{name}_error"]
    return shown("" if row[name] is None or error is None else f"{100 * row[name]:+.2f} ± {100 * error:.2f}")


def _print_orbit(orbit: "OrbitStudy") -> None:
    from idealgas.presentation.tables import Number, Table

    def cells(s: "Survival") -> tuple["Cell", ...]:
        least, most = (Number(f(s.times) if s.times else None, ".4g") for f in (min, max))
        here, median, unbroken = Number(s.scene, ".4g", "unbroken"), Number(s.median, ".4g"), Number(s.unbroken, "d")
        return s.precision, Number(s.digits, ".1f"), here, median, least, most, unbroken

    title = f"Unstable periodic orbit, period {orbit.period:.6g}, {orbit.placements} boxes and radii"
    heads = ("", "digits", "this box", "median", "least", "most", "unbroken")
    print_tables([Table(title, heads, [cells(survival) for survival in orbit.survivals])])
