"""Profiles of density and temperature in strips along an axis, and the heat given by walls."""

from idealgas.analysis.core.declaration import Analysis, Option, Section

BINS = 20

ANALYSIS = Analysis(
    __name__,
    help="""Measure density and temperature in strips along an axis, and the heat given by walls.

    Theory, for a dilute gas: uniform in a closed or periodic box, barometric under gravity, and T^(3/2) linear in the
    position between two thermal sides, with the temperature jumps at them.
    """,
    options=(
        Option(
            "along",
            str,
            "Axis of the profile.  [default: that of gravity, or of two thermal sides; else x]",
            choices=("x", "y"),
        ),
        Option("bins", int, "Number of strips.", default=BINS, least=1, most=1000),
    ),
    worded=True,
    sections=(Section("Profile", "Density and temperature in strips along an axis, theory dashed"),),
    reads="frames",
)
