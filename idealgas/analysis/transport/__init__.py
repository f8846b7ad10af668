"""How discs move among each other: collisions, memory of the velocity, diffusion, and neighbours."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure collision rates, free paths, the memory of velocities, diffusion and the pair distribution.

    Beside them stand kinetic theory's rates and Enskog's diffusion; the distribution of free paths is that of `idealgas
    histogram --quantity free-path`.
    """,
    sections=(Section("Transport", "Memory of the velocity, mean square displacement and pair distribution"),),
)
