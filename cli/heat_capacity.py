"""`idealgas heat-capacity`: how much energy does a degree cost?"""

import click

from ._analysis import plot_option, print_estimates, print_json, reading, window_options
from ._options import json_option


@click.command()
@click.argument("paths", metavar="RUN.h5...", nargs=-1, required=True)
@window_options
@plot_option
@json_option
def heat_capacity(
    paths: tuple[str, ...], start: float | None, end: float | None, plot: str | None, as_json: bool
) -> None:
    """Measure the heat capacity at constant area.

    Several logs of different temperatures give the slope dE/dT; one log gives E/T. The thermometer is the pressure on
    the walls, which knows nothing of the energy.
    """
    from contextlib import ExitStack

    from idealgas.analysis.heat_capacity import heat_capacity as measure
    from idealgas.log import open_log

    with ExitStack() as stack:
        logs = [stack.enter_context(open_log(path)) for path in paths]
        result = measure(logs, start, end, stack.enter_context(reading()))
    if plot:
        from idealgas.analysis.figures import heat_capacity_figure, save

        save(heat_capacity_figure(result), plot)
    if as_json:
        print_json(result.as_dict())
        return
    print_estimates(
        "Temperature by wall pressure, theory E/N", [(point.path, point.temperature) for point in result.points]
    )
    of = "" if result.number is None else f", N = {result.number}"
    print_estimates(f"Heat capacity per disc{of}", [(f"{result.route} /N", result.per_disc)])
    click.echo(result.explanation)
