"""Density and temperature in strips along an axis, and the heat that walls give."""

from idealgas.analysis.core.declaration import Analysis, Option, Section

BINS = 20

ANALYSIS = Analysis(
    __name__,
    help="""Measure density and temperature in strips along an axis, and the heat that walls give.

    Theory: uniform in a closed or periodic box, barometric under gravity, T^(3/2) in a straight line between two
    thermal sides. It is that of a dilute gas, without the jump of the temperature at a thermal side.
    """,
    options=(
        Option(
            "along",
            str,
            "The axis.  [default: that of gravity, or of two thermal sides; else x]",
            choices=("x", "y"),
        ),
        Option("bins", int, "Number of strips.", default=BINS, least=1, most=1000),
    ),
    sections=(Section("Profile", "Density and temperature in strips along an axis, theory dashed"),),
    reads="frames",
)
