"""Evolution in time: temperature, energies, energy given by walls, piston, and discs beyond a gate."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Follow temperature, discs beyond a gate, piston and energies in time, with the law of the temperature.

    Laws: Haff's law for a cooling gas, the adiabat of a slow piston, the rest position of a piston under pressure, and
    equilibrium for isolated gases, gases under gravity and heat baths.
    """,
    sections=(
        Section("Evolution", "Temperature against time with its law dashed, then the gate, the piston and the walls"),
    ),
    start="the log's start",
    reads="frames",
)
