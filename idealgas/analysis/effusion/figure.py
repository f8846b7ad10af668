"""Picture of the flow of gases through a slit."""

import numpy as np
from matplotlib.figure import Figure

from idealgas.analysis.core.style import GREY, curve_style, panels
from idealgas.analysis.effusion.combine import Effusions


def effusion_figure(found: Effusions) -> Figure:
    """Picture of the share of the discs beyond the slit against time, and of the flux of each gas beside n⟨v⟩/π."""
    groups, together = found.groups, found.together
    figure, (course, flux) = panels(2)
    for k, (name, runs) in enumerate(groups.items()):
        colour, line, marker = curve_style(k)
        beyond = np.mean([run.beyond for run in runs], axis=0)
        course.plot(runs[0].time, beyond, line, color=colour, label=name)
        if laws := [run.expected for run in runs if run.expected is not None]:
            course.plot(runs[0].time, np.mean(laws, axis=0), "--", color=GREY, linewidth=0.8)
        n, speed = runs[0].density, together[name]
        if speed.theory is None:
            flux.axhline(n * speed.value, color=colour, linestyle=line, label=f"{name}: no theory")
        else:
            expected, value, error = n * speed.theory, n * speed.value, n * speed.standard_error
            flux.errorbar(expected, value, error, fmt=marker, color=colour, capsize=3)
    ends = np.array([0.0, 1.1 * max(runs[0].density * (together[name].theory or 0) for name, runs in groups.items())])
    flux.plot(ends, ends, "--", color=GREY, label="n⟨v⟩/π")
    course.set_xlabel("t (time)")
    course.set_ylabel("discs beyond the slit (no unit)")
    flux.set_xlabel("n⟨v⟩/π (1/(length time))")
    flux.set_ylabel("flux (1/(length time))")
    course.legend()
    flux.legend()
    return figure
