"""Measure the flow through a gate that opens, and compare it with n⟨v⟩/π.

DIR is the folder of a sweep with the analysis "effusion"; runs that differ only in their seeds are averaged.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.analysis import Analysis, Section
from idealgas.analysis.effusion.combine import Effusions, combine_effusion, effusion_tables, restore_effusion
from idealgas.analysis.effusion.measure import Effusion, effusion

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class EffusionAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `effusion`."""

    position = 110
    results = (
        Effusion,
        Effusions,
    )
    sections = (Section("Effusion", "Fraction of the discs beyond the gate against time, and the flux beside n⟨v⟩/π"),)
    averages = True
    start = "the opening of the gate"
    reads = "frames"

    measure = staticmethod(effusion)
    tables = staticmethod(effusion_tables)
    combine = staticmethod(combine_effusion)
    restore = staticmethod(restore_effusion)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.effusion.figure import effusion_figure

        return effusion_figure(result)
