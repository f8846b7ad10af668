"""`idealgas heat-capacity`: how much energy does a degree cost?"""

import click

from ._analysis import analysis_options, open_log, print_estimates, print_json, reading


@click.command()
@click.argument("paths", metavar="RUN.h5|DIR...", nargs=-1, required=True)
@analysis_options
def heat_capacity(
    paths: tuple[str, ...], start: float | None, end: float | None, plot: str | None, as_json: bool
) -> None:
    """Measure the heat capacity by every route that the logs allow.

    Logs of several temperatures give the slope dE/dT. One log gives E/T by the pressure on the walls of a closed box,
    Var(E)/T² in a heat bath, and with spin, gravity or a piston the fluctuations of the kinetic energy. A folder is
    that of a sweep with the analysis "heat-capacity".
    """
    import os

    from idealgas.analysis.heat_capacity.measure import heat_capacity as put_together
    from idealgas.analysis.heat_capacity.measure import measure_heat
    from idealgas.study.sweep.results import heat_measurements

    measured = []
    for path in paths:
        if os.path.isdir(path):
            measured += heat_measurements(path)
            continue
        with open_log(path) as log, reading() as progress:
            measured.append(measure_heat(log, start, end, progress))
    result = put_together(measured)
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.analysis.heat_capacity.figure import heat_capacity_figure

        save(heat_capacity_figure(result), plot)
    if as_json:
        print_json(result.as_dict())
        return
    if len(result.logs) <= 12:
        rows = [(f"{m.path}: E/N", m.energy) for m in result.logs]
        rows += [(f"{m.path}: T by {m.thermometer}", m.temperature) for m in result.logs]
        print_estimates("Logs", rows)
    print_estimates("C per disc, and γ", [(f"{route.name}, {route.kind}", route.value) for route in result.routes])
    for name, why in result.refused.items():
        click.echo(f"no {name}: {why}")
