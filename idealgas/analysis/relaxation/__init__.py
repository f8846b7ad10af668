"""How the velocities of a gas come to follow Maxwell and Boltzmann's distribution."""

from idealgas.analysis.core.declaration import Analysis, Option, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure how the velocities come to follow Maxwell and Boltzmann.

    The relaxation time is that of an exponential fitted to the kurtosis of the velocities; its error comes from groups
    of discs. Several logs lie on one plot.
    """,
    options=(
        Option(
            "every",
            float,
            "Also show the speeds every so many trials of a Monte Carlo run, or units of time of any other.",
            positive=True,
            metavar="X",
        ),
    ),
    sections=(
        Section(
            "Relaxation",
            "Kurtosis of the velocity, Kolmogorov-Smirnov distance and Boltzmann's H on the way to equilibrium",
        ),
    ),
    several=True,
    start="the log's start",
    end="after 40 collisions per disc",
    reads="instants",
)
