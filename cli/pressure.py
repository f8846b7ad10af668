"""`idealgas pressure`: does PV = NkT hold?"""

from typing import TYPE_CHECKING, Any

import click

from ._analysis import analysis_options, describe, open_log, print_estimates, print_json, reading

if TYPE_CHECKING:
    from idealgas.analysis.pressure.equation_of_state import EquationOfState
    from idealgas.analysis.pressure.measure import Pressure


@click.command()
@click.argument("paths", metavar="RUN.h5|DIR...", nargs=-1, required=True)
@analysis_options
@click.option("--check", is_flag=True, help="Exit with 1 unless measurement and theory agree within 4 s.e.")
def pressure(
    paths: tuple[str, ...], start: float | None, end: float | None, plot: str | None, as_json: bool, check: bool
) -> None:
    """Measure the pressure from the walls and from the virial, and compare Z = PA/NT with 1 and with hard discs.

    Collision rates and mean free paths come from the same events. Several logs, or the folder of a sweep with the
    analysis "pressure", give the equation of state: Z against the packing fraction, and the virial coefficients in it.
    """
    import os

    from idealgas.analysis.pressure.measure import TOLERANCE
    from idealgas.analysis.pressure.measure import pressure as measure

    result: Any
    show: Any
    if len(paths) == 1 and not os.path.isdir(paths[0]):
        with open_log(paths[0]) as log, reading() as progress:
            result = measure(log, start, end, progress)
        agrees, figure, show = result.check() if check else None, "pressure_figure", _print_pressure
    else:
        result = _equation_of_state(paths, start, end)
        agrees, figure = result.check(TOLERANCE) if check else None, "equation_of_state_figure"
        show = _print_equation_of_state
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.analysis.pressure import figure as figures

        save(getattr(figures, figure)(result), plot)
    if as_json:
        print_json(result.as_dict() | {"agrees": agrees})
    else:
        show(result)
        if agrees is not None:
            verdict = "agree" if agrees else "do not agree"
            click.echo(f"Measurement and theory {verdict} within {TOLERANCE:g} standard errors.")
    if agrees is False:
        raise SystemExit(1)


def _equation_of_state(paths: tuple[str, ...], start: float | None, end: float | None) -> "EquationOfState":
    import os

    from idealgas.analysis.pressure.equation_of_state import equation_of_state, sample_of
    from idealgas.analysis.pressure.measure import pressure as measure
    from idealgas.study.sweep.results import pressure_samples

    samples = []
    for path in paths:
        if os.path.isdir(path):
            samples += pressure_samples(path)
            continue
        with open_log(path) as log, reading() as progress:
            samples.append(sample_of(measure(log, start, end, progress)))
    return equation_of_state(samples)


def _print_pressure(result: "Pressure") -> None:
    click.echo(describe(result.window))
    phi, temperature = result.packing_fraction, result.temperature
    click.echo(f"N = {result.number}, A = {result.area:g}, φ = {phi:.5g}, T = {temperature:.6g}")
    print_estimates(
        "Z = PA/NT",
        [(f"{route.name}, P = {route.pressure.value:.5g}", route.compressibility) for route in result.routes],
    )
    for name, value in result.theories.items():
        click.echo(f"Z = {value:.6f}  {name}")
    print_estimates(
        "Collisions per disc and time",
        [(f"{rate.species} with {rate.other}", rate.rate) for rate in result.collision_rates],
    )
    print_estimates(
        "Between collisions of a disc",
        [
            (f"{entry.species}: {name}", estimate)
            for entry in result.free_paths
            for name, estimate in (
                ("mean free path", entry.path),
                ("mean free time", entry.time),
                ("mean speed", entry.speed),
            )
        ],
    )


def _print_equation_of_state(result: "EquationOfState") -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(title="Z = PA/NT for N → ∞; deviations are from the resummed virial series", title_justify="left")
    for head in ("φ", "runs", "Z", "± s.e.", "dev./s.e.", "resummed", "to B10", "Henderson"):
        table.add_column(head, justify="right")
    for state in result.states:
        z = state.infinite
        theories = (f"{value:.5f}" for value in (z.theory, state.virial, state.henderson))
        measured = (f"{z.value:.5f}", f"{z.standard_error:.1g}", f"{z.deviation or 0:+.2f}")
        table.add_row(f"{state.packing_fraction:.5g}", f"{state.runs}", *measured, *theories)
    Console().print(table)
    if result.b2 and result.b3:
        print_estimates(
            "Virial coefficients, fitted", [("B2 in units of the disc's area", result.b2), ("B3/B2²", result.b3)]
        )
    else:
        click.echo("Too few states at low density for a fit of virial coefficients.")
