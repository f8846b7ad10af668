"""Flow of discs through a gate that opens."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure the flow through a gate that opens, and compare it with n⟨v⟩/π.

    DIR is the folder of a sweep with the analysis "effusion"; runs that differ only in their seeds are averaged.
    """,
    sections=(Section("Effusion", "Share of the discs beyond the gate against time, and the flux beside n⟨v⟩/π"),),
    several=True,
    averages=True,
    folders=True,
    start="the opening of the gate",
    reads="frames",
)
