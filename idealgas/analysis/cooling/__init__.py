"""Cooling of a gas whose discs lose energy in collisions: Haff's law, cumulant, spin and clusters."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure how a gas cools whose discs lose energy in collisions: Haff's law, a₂, spin and clusters.

    Haff's time and the loss per collision with the Sonine correction, the fourth cumulant a₂ of the velocities, the
    ratio of the temperatures of spin and motion of rough discs, and how much numbers of discs in small cells scatter,
    which tells when clusters form.
    """,
    sections=(
        Section(
            "Cooling",
            "Temperature against time, then cumulant, temperature ratio of rough discs, and the scatter of numbers and "
            "momenta in cells against collisions of a disc; theory dashed",
        ),
    ),
    start="20 collisions per disc, or more with slow spins",
    reads="frames",
)
