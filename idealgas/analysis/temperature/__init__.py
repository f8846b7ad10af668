"""Temperature of every degree of freedom and species; by equipartition all are equal."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="Measure the temperature of every degree of freedom and species; by equipartition all are E/N.",
    worded=True,
    sections=(Section("Temperature", "Kinetic temperature of each species against time"),),
)
