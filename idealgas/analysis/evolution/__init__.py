"""Evolution in time: temperature, pressure, energies, energy given by walls, piston, and discs beyond a gate."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Follow temperature, pressure, discs beyond a gate, piston and energies in time, with the temperature's law.

    Laws: Haff's law for a cooling gas, the adiabat of a slow piston, the rest position of a piston under pressure, and
    equilibrium for isolated gases, gases under gravity and heat baths. The pressure is the mechanical one on the walls.
    With a piston the picture has the pressure against the area, with the isotherm and the adiabat through the start.
    """,
    worded=True,
    sections=(
        Section(
            "Evolution",
            "Temperature in time with its law dashed, then the gate, the pressure, the piston and the walls",
        ),
    ),
    start="the log's start",
    reads="frames",
)
