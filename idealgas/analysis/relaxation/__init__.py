"""Relaxation of the velocities of a gas to Maxwell-Boltzmann's distribution."""

from idealgas.analysis.core.declaration import Analysis, Option, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure the relaxation of the velocities to Maxwell-Boltzmann's distribution.

    The relaxation time is that of an exponential fitted to the kurtosis of the velocities; its error is that
    of the fluctuations of a gas of so many discs. Several logs are drawn in one picture.
    """,
    options=(
        Option(
            "every",
            float,
            "Also show the speed distribution every X trials (Monte Carlo) or X units of time (other runs).",
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
