"""Picture of relaxations: several logs together, against collisions per disc and against time."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from idealgas.analysis.core.style import COLOURS, GREY, panels
from idealgas.analysis.relaxation.combine import Relaxations

STYLES = ("-", "--", "-.", ":")
DISTANCES = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5)
ENTROPIES = (-0.1, -0.05, 0, 0.05, 0.1, 0.2, 0.5, 1, 2)
"""Ticks of the axes with both small and large values."""


def relaxation_figure(found: Relaxations) -> Figure:
    """Picture of kurtosis with its fit, Kolmogorov-Smirnov distance and Boltzmann's H.

    They are drawn against collisions per disc on the left and against time on the right.
    """
    figure, axes = panels(3, columns=2)
    for k, result in enumerate(found.logs):
        colour, style = COLOURS[k % len(COLOURS)], STYLES[k // len(COLOURS) % len(STYLES)]
        name = f"{Path(result.path).stem}, N = {result.number}"
        for column, x in enumerate((result.collisions, result.time - result.time[0])):
            kurtosis, distance, entropy = axes[column::2]
            kurtosis.plot(x, result.kurtosis, style, color=colour, linewidth=1.2, label=name)
            fit = (result.in_collisions, result.in_time)[column]
            if fit is not None:
                start, target = result.kurtosis[0], result.equilibrium_kurtosis
                model = target + (start - target) * np.exp(-x / fit.value)
                kurtosis.plot(x, model, color=colour, linewidth=2.5, alpha=0.35)
            distance.plot(x, result.distance, style, color=colour, linewidth=1.2)
            distance.axhline(result.critical_distance, color=colour, linestyle=":", linewidth=1)
            entropy.plot(x, result.entropy, style, color=colour, linewidth=1.2)
    for column, x_name in enumerate(("collisions per disc (no unit)", "time since the start (time)")):
        kurtosis, distance, entropy = axes[column::2]
        kurtosis.axhline(2, color=GREY, linestyle="--", label="Maxwell-Boltzmann")
        kurtosis.set_ylabel("kurtosis ⟨v⁴⟩/⟨v²⟩² (no unit)")
        distance.set_ylabel("KS distance (no unit)")
        distance.set_yscale("log")
        distance.yaxis.set_major_locator(FixedLocator(DISTANCES))
        distance.yaxis.set_major_formatter("{x:g}")
        distance.yaxis.set_minor_locator(NullLocator())
        entropy.set_ylabel("H - H of equilibrium, per disc (no unit)")
        if max(result.entropy.max() for result in found.logs) > 0.5:
            entropy.set_yscale("symlog", linthresh=0.1)
            entropy.yaxis.set_major_locator(FixedLocator(ENTROPIES))
            entropy.yaxis.set_major_formatter("{x:g}")
        for ax in (kurtosis, distance, entropy):
            ax.set_xlim(left=0)
            ax.set_xlabel(x_name)
    axes[0].legend(frameon=False, fontsize="small", loc="lower right")
    axes[0].set_title("pale: fitted exponential", fontsize="small", color=GREY)
    axes[2].set_title("dotted: exceeded by 1 in 20 gases in equilibrium", fontsize="small", color=GREY)
    return figure
