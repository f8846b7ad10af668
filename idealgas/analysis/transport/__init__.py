"""Transport: collision rates, free paths, diffusion, viscosities, heat conductivity and pair distribution."""

from idealgas.analysis.core.declaration import Analysis, Option, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure diffusion, viscosities and heat conductivity, collision rates, free paths and the pair distribution.

    They are compared with Enskog's theory and the rates of kinetic theory. Viscosities, heat conductivity and the
    pressure tensor take a box with periodic sides. `idealgas histogram --quantity free-path` measures the distribution
    of free paths. Several logs, or the folder of a sweep with the analysis "transport", give the coefficients over
    Enskog's against the packing fraction.
    """,
    sections=(
        Section(
            "Transport",
            "Velocity correlation, mean square displacement, pair distribution, and transport coefficients over time",
        ),
    ),
    several=True,
    averages=True,
    folders=True,
    options=(
        Option(
            "lag",
            float,
            "Longest time for which discs and currents are followed, in mean free times.",
            default=20.0,
            positive=True,
            metavar="X",
        ),
    ),
)
