"""Measure density and temperature in strips along an axis, and the heat given by walls.

Theory, for a dilute gas: uniform in a closed or periodic box, barometric under gravity, and T^(3/2) linear in the
position between two thermal sides, with the temperature jumps at them.
"""

from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.analysis import Analysis, Option, Section
from idealgas.analysis.profile.measure import BINS, Profile, profile
from idealgas.analysis.profile.tables import profile_summary, profile_tables

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class ProfileAnalysis(Analysis):
    """Declaration of the analysis; its docstring for users is that of `profile`."""

    position = 40
    results = (Profile,)
    sections = (Section("Profile", "Density and temperature in strips along an axis, theory dashed"),)
    options = (
        Option(
            "along",
            str,
            "Axis of the profile.  [default: that of gravity, or of two thermal sides; else x]",
            choices=("x", "y"),
        ),
        Option("bins", int, "Number of strips.", default=BINS, least=1, most=1000),
    )
    reads = "frames"

    measure = staticmethod(profile)
    tables = staticmethod(profile_tables)
    summary = staticmethod(profile_summary)

    @staticmethod
    def figure(result: Any) -> "Figure":
        """Picture of the result; matplotlib is imported where it is drawn."""
        from idealgas.analysis.profile.figure import profile_figure

        return profile_figure(result)
