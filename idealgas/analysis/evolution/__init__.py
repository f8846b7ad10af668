"""The course in time of temperatures, energies and the account of the walls, and of discs beyond a gate."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Follow temperature, discs beyond a gate, piston and energy account in time, with the law of the temperature.

    Laws: Haff's for a gas that cools, the adiabat of a slow piston, the place of a piston under pressure, and
    equilibrium for isolated gases, columns under gravity and heat baths.
    """,
    sections=(
        Section("Evolution", "Temperature against time with its law dashed, then the gate, the piston and the walls"),
    ),
    start="the log's start",
    reads="frames",
)
