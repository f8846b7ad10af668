"""`idealgas transport`: how do discs get about among each other?"""

import click

from ._analysis import analysis_options, describe, log_argument, open_log, print_estimates, print_json, reading


@click.command()
@log_argument
@analysis_options
def transport(path: str, start: float | None, end: float | None, plot: str | None, as_json: bool) -> None:
    """Measure collision rates, free paths, the memory of velocities, diffusion and the pair distribution.

    Beside them stand kinetic theory's rates and Enskog's diffusion; the distribution of free paths is that of `idealgas
    histogram --quantity free-path`.
    """
    from idealgas.analysis.transport.measure import transport as measure

    with open_log(path) as log, reading() as progress:
        result = measure(log, start, end, progress)
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.analysis.transport.figure import transport_figure

        save(transport_figure(result), plot)
    if as_json:
        print_json(result.as_dict())
        return
    click.echo(describe(result.window))
    print_estimates(
        "Collisions per disc and time", [(f"{r.species} with {r.other}", r.rate) for r in result.collision_rates]
    )
    print_estimates(
        "Between collisions of a disc",
        [
            (f"{entry.species}: {name}", estimate)
            for entry in result.free_paths
            for name, estimate in (("mean free path", entry.path), ("mean free time", entry.time))
        ],
    )
    print_estimates("g(r) at contact", [(f"{c.species} and {c.other}", c.value) for c in result.contacts])
    print_estimates(
        "Diffusion, theory Enskog's",
        [
            row
            for entry in result.diffusion
            for row in (
                (f"{entry.species}: D by displacement", entry.coefficient),
                (f"{entry.species}: velocity correlation time", entry.velocity_correlation_time),
            )
        ],
    )
    if result.walled:
        click.echo("Walls turn discs back: D is that of an endless gas only in a box much wider than their way.")
