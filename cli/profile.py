"""`idealgas profile`: how do density and temperature change along an axis?"""

import click

from ._analysis import analysis_options, describe, log_argument, open_log, print_estimates, print_json, reading


@click.command()
@log_argument
@click.option(
    "--along",
    type=click.Choice(["x", "y"]),
    help="The axis.  [default: that of gravity, or of two thermal sides; else x]",
)
@click.option("--bins", type=click.IntRange(1, 1000), default=20, show_default=True, help="Number of strips.")
@analysis_options
def profile(
    path: str, along: str | None, bins: int, start: float | None, end: float | None, plot: str | None, as_json: bool
) -> None:
    """Measure density and temperature in strips along an axis, and the heat that walls give.

    Theory: uniform in a closed or periodic box, barometric under gravity, T^(3/2) in a straight line between two
    thermal sides. It is that of a dilute gas, without the jump of the temperature at a thermal side.
    """
    from idealgas.analysis.profile.measure import profile as measure

    with open_log(path) as log, reading("frames") as progress:
        result = measure(log, along, bins, start, end, progress)
    if plot:
        from idealgas.analysis.core.style import save
        from idealgas.analysis.profile.figure import profile_figure

        save(profile_figure(result), plot)
    if as_json:
        print_json(result.as_dict())
        return
    click.echo(f"{describe(result.window)}, {result.frames} frames")
    click.echo(f"theory: {result.law or 'none for this scene'}")
    axis = "xy"[result.axis]
    places = [f"{axis} = {low:.4g} to {high:.4g}" for low, high in zip(result.edges, result.edges[1:], strict=False)]
    for entry in result.species:
        columns = [("Density (1/length²)", entry.density), ("Temperature, m v²/2", entry.temperature)]
        columns += [("Temperature, I ω²", entry.spin)] if entry.spin is not None else []
        for title, column in columns:
            print_estimates(f"{entry.species}: {title}", list(zip(places, column, strict=True)))
    if result.heat:
        print_estimates("Energy from each wall per time", list(result.heat.items()))
