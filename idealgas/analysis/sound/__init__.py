"""Sound: how fast the longest waves of density run in a periodic box, and how they die out."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure the speed and the damping of sound by the longest waves of density in a periodic box.

    Theory: the speed by the equation of state, the damping by Enskog's viscosities and heat conductivity.
    """,
    sections=(Section("Sound", "Correlation in time of the longest waves of density, hydrodynamics dashed"),),
    reads="frames",
)
