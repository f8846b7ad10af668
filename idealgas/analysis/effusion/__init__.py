"""The flow of discs through a slit that opens."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure the flow through a gate that opens, and compare it with n⟨v⟩/π.

    A folder is that of a sweep with the analysis "effusion"; runs that differ in their seeds alone are put together.
    """,
    sections=(Section("Effusion", "Share of the discs beyond the gate against time, and the flux beside n⟨v⟩/π"),),
    several=True,
    folders=True,
    start="the opening of the gate",
    reads="frames",
)
