"""`idealgas temperature`: has every degree of freedom its share?"""

import click

from ._analysis import analysis_options, describe, log_argument, open_log, print_estimates, print_json, reading


@click.command()
@log_argument
@analysis_options
def temperature(path: str, start: float | None, end: float | None, plot: str | None, as_json: bool) -> None:
    """Measure the temperature of every degree of freedom and species; by equipartition all are E/N."""
    from idealgas.analysis.temperature.measure import temperature as measure

    with open_log(path) as log, reading() as progress:
        result = measure(log, start, end, progress)
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.analysis.temperature.figure import temperature_figure

        save(temperature_figure(result), plot)
    if as_json:
        print_json(result.as_dict())
        return
    click.echo(describe(result.window))
    rows = [
        (f"{entry.species}: {direction}", estimate)
        for entry in result.species
        for direction, estimate in (("m vx²", entry.x), ("m vy²", entry.y), ("m v²/2", entry.both))
    ]
    print_estimates("Temperatures (k_B = 1), theory E/N", rows)
