"""`idealgas pressure`: does PV = NkT hold?"""

import click

from ._analysis import describe, log_argument, plot_option, print_estimates, print_json, reading, window_options
from ._options import json_option


@click.command()
@log_argument
@window_options
@plot_option
@json_option
@click.option("--check", is_flag=True, help="Exit with 1 unless both virials agree with theory within 4 s.e.")
def pressure(path: str, start: float | None, end: float | None, plot: str | None, as_json: bool, check: bool) -> None:
    """Measure the pressure from the walls and from the virial, and compare Z = PA/NT with 1 and with hard discs.

    Collision rates and mean free paths come from the same events.
    """
    from idealgas.analysis.pressure import TOLERANCE
    from idealgas.analysis.pressure import pressure as measure
    from idealgas.log import open_log

    with open_log(path) as log, reading() as progress:
        result = measure(log, start, end, progress)
    if plot:
        from idealgas.analysis.figures import pressure_figure, save

        save(pressure_figure(result), plot)
    agrees = result.check() if check else None
    if as_json:
        print_json(result.as_dict() | {"agrees": agrees})
    else:
        click.echo(describe(result.window))
        phi, temperature = result.packing_fraction, result.temperature
        click.echo(f"N = {result.number}, A = {result.area:g}, φ = {phi:.5g}, T = E/N = {temperature:.6g}")
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
        if agrees is not None:
            verdict = "agree" if agrees else "do not agree"
            click.echo(f"Measurement and theory {verdict} within {TOLERANCE:g} standard errors.")
    if agrees is False:
        raise SystemExit(1)
