"""Order of discs: hexagonal order of neighbours, its correlation, structure factor and positional order."""

from idealgas.analysis.core.declaration import Analysis, Section

ANALYSIS = Analysis(
    __name__,
    help="""Measure the order of the discs: ψ₆ of neighbours, its correlation g₆(r) and the structure factor S(k).

    ψ₆ tells how well the neighbours of a disc stand at the corners of a hexagon; its mean over all discs is 1 in a
    crystal and of the order of 1/√N in a fluid. S(k), in a periodic box only, tells how well the discs stand in rows;
    theory knows its limit at small k, the compressibility of the fluid. A run without events is measured at its
    checkpoints.
    """,
    sections=(
        Section(
            "Order",
            "Hexagonal order against time and its correlation against distance; in a periodic box the structure factor",
        ),
    ),
    reads="frames",
)
