"""Picture of relaxations against time, of several logs also against collisions per disc."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from idealgas.analysis.core.style import BLACK, Panel, curve_style, panels
from idealgas.analysis.relaxation.measure import Relaxations

DISTANCES = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5)
"""Ticks of the axis of distances, which has both small and large values."""


def relaxation_figure(found: Relaxations) -> Figure:
    """Picture of kurtosis with its fit, Kolmogorov-Smirnov distance and Boltzmann's H against time.

    Of several logs it has the same against collisions per disc, on the left.
    """
    if len(found.logs) == 1:
        figure, axes = panels(3)
        _draw(axes, found, in_time=True)
    else:
        figure, axes = panels(3, columns=2)
        _draw(axes[::2], found, in_time=False)
        _draw(axes[1::2], found, in_time=True)
    return figure


def _draw(axes: Sequence[Panel], found: Relaxations, in_time: bool) -> None:
    """Draw three panels against time, or against collisions per disc."""
    kurtosis, distance, entropy = axes
    for k, result in enumerate(found.logs):
        colour, line, _ = curve_style(k)
        name = f"{Path(result.path).stem}, N = {result.number}"
        x, fit = (result.time, result.in_time) if in_time else (result.collisions, result.in_collisions)
        kurtosis.plot(x, result.kurtosis, line, color=colour, linewidth=1.2, label=name)
        if fit is not None:
            start, target = result.kurtosis[0], result.equilibrium_kurtosis
            model = target + (start - target) * np.exp(-(x - x[0]) / fit.value)
            kurtosis.plot(x, model, color=colour, linewidth=2.5, alpha=0.35, label="fitted exponential")
        distance.plot(x, result.distance, line, color=colour, linewidth=1.2, label=name)
        distance.axhline(
            result.critical_distance, color=colour, linestyle=":", linewidth=1, label="1 in 20 gases is beyond it"
        )
        entropy.plot(x, result.entropy, line, color=colour, linewidth=1.2, label=name)
        for ax in axes:
            ax.set_xlim(x[0], x[-1])
            ax.time_axis() if in_time else ax.set_xlabel("collisions per disc (no unit)")
    kurtosis.axhline(2, color=BLACK, linestyle="--", label="Maxwell-Boltzmann")
    kurtosis.set_ylabel("kurtosis ⟨v⁴⟩/⟨v²⟩² (no unit)")
    distance.set_ylabel("KS distance (no unit)")
    distance.set_yscale("log")
    distance.yaxis.set_major_locator(FixedLocator(DISTANCES))
    distance.yaxis.set_major_formatter("{x:g}")
    distance.yaxis.set_minor_locator(NullLocator())
    entropy.axhline(0, color=BLACK, linestyle="--", label="equilibrium")
    entropy.set_ylabel("H less that of equilibrium, per disc (no unit)")
    for ax in axes:
        ax.legend()
