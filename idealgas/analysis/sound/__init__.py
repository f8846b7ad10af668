"""Measure the speed and the damping of sound by the longest waves of density in a periodic box.

Theory: the speed by the equation of state, the damping by Enskog's viscosities and thermal conductivity.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.analysis import Analysis, Section
from idealgas.analysis.sound.measure import Sound, sound
from idealgas.analysis.sound.tables import sound_tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class SoundAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `sound`."""

    position = 90
    results = (Sound,)
    sections = (Section("Sound", "Correlation in time of the longest waves of density, hydrodynamics dashed"),)
    reads = "frames"

    measure = staticmethod(sound)
    tables = staticmethod(sound_tables)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.sound.figure import sound_figure

        return sound_figure(result)
