"""Heat capacity per disc by every route that one or several logs allow."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure the heat capacity by every route that the logs allow.

    Logs at several temperatures give the slope dE/dT. One log gives E/T by the pressure on the walls of a closed box,
    Var(E)/T² in a heat bath, and with spin, gravity or a piston the fluctuations of the kinetic energy. DIR is the
    folder of a sweep with the analysis "heat-capacity".
    """,
    sections=(Section("Heat capacity", "Heat capacity per disc by every route with its standard error, and theory"),),
    several=True,
    averages=True,
    folders=True,
)
