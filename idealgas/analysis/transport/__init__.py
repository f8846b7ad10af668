"""Transport: collision rates, free paths, velocity correlation, diffusion and pair distribution."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure collision rates, free paths, velocity correlation, diffusion and the pair distribution.

    They are compared with the rates of kinetic theory and Enskog's diffusion coefficient. `idealgas histogram
    --quantity free-path` measures the distribution of free paths.
    """,
    sections=(Section("Transport", "Velocity correlation, mean square displacement and pair distribution"),),
)
