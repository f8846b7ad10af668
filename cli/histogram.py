"""`idealgas histogram`: how are speeds, energies and free flights distributed?"""

import click

from ._analysis import analysis_options, describe, log_argument, open_log, print_estimates, print_json, reading

QUANTITIES = ("speed", "vx", "vy", "energy", "free-path", "free-time", "wait")


@click.command()
@log_argument
@click.option("--quantity", type=click.Choice(QUANTITIES), default="speed", show_default=True, help="What of.")
@analysis_options
def histogram(
    path: str, quantity: str, start: float | None, end: float | None, plot: str | None, as_json: bool
) -> None:
    """Measure a distribution and test it against its laws.

    Velocities count with the time spent at them; waits are those between successive events of the gas. The
    Kolmogorov-Smirnov tests take decorrelated samples.
    """
    from idealgas.analysis.histogram.measure import histogram as measure

    with open_log(path) as log, reading() as progress:
        result = measure(log, quantity, start, end, progress)
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.analysis.histogram.figure import histogram_figure

        save(histogram_figure(result), plot)
    if as_json:
        print_json(result.as_dict())
        return
    from rich.console import Console
    from rich.table import Table

    click.echo(describe(result.window))
    print_estimates(f"Mean {quantity}", [(found.name, found.mean) for found in result.distributions])
    table = Table("", "law", title="Kolmogorov-Smirnov tests", title_justify="left")
    for head in ("distance", "p", "samples", "spacing"):
        table.add_column(head, justify="right")
    for found in result.distributions:
        spacing = "" if found.correlation_time is None else f"{found.correlation_time:.4g}"
        for test in found.tests:
            numbers = (f"{test.distance:.4f}", f"{test.p_value:.3g}", f"{found.samples}", spacing)
            table.add_row(found.name, test.law_name, *numbers)
    Console().print(table)
