"""Picture of the cooling of a gas."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from idealgas.analysis.cooling.measure import Cooling
from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.style import COLOURS, GREY, panels


def cooling_figure(result: Cooling) -> Figure:
    """Picture of the temperature against time, and of cumulant, temperature ratio and scatter against collisions."""
    rough = result.temperature_ratio is not None
    figure, axes = panels(4 if rough else 3)
    _temperatures(axes[0], result)
    rest = iter(axes[1:])
    _mean(next(rest), result, result.cumulant, result.fourth, "a₂ (no unit)")
    if rough and result.spin is not None and result.temperature_ratio is not None:
        ratio = result.spin / result.temperature
        _mean(next(rest), result, ratio, result.temperature_ratio, "spin over motion (no unit)")
    ax = next(rest)
    ax.plot(result.collisions, result.scatter, color=COLOURS[0], label="numbers: variance over mean")
    ax.plot(result.collisions, result.flow, color=COLOURS[1], label="momenta: square over that by chance")
    ax.set(ylabel=f"in {result.cells} cells (no unit)", xlabel="collisions per disc", yscale="log")
    for ax in axes:
        ax.legend(frameon=False, fontsize="small")
    return figure


def _temperatures(ax: Axes, result: Cooling) -> None:
    shown = result.time > 0
    ax.plot(result.time[shown], result.temperature[shown], color=COLOURS[0], label="kinetic energy per disc")
    if result.spin is not None:
        ax.plot(result.time[shown], result.spin[shown], color=COLOURS[1], label="I ω² per disc")
    for law, label in ((result.law, "law of a uniform gas"), (result.spin_law, None)):
        if law is not None:
            ax.plot(result.time[shown], law[shown], "--", color=GREY, label=label)
    ax.set(xscale="log", yscale="log", xlabel="t (time)", ylabel="temperature (energy, k_B = 1)")


def _mean(ax: Axes, result: Cooling, series: np.ndarray, found: Estimate, label: str) -> None:
    """A series against collisions, with its mean over the window and theory."""
    ax.plot(result.collisions, series, color=COLOURS[5], linewidth=0.9, label="measured")
    window = result.collisions[[int(result.time.searchsorted(t)) for t in (result.start, result.end)]]
    ax.plot(window, [found.value] * 2, color=COLOURS[0], label="mean")
    if found.theory is not None:
        ax.axhline(found.theory, color=GREY, linestyle="--", label="theory")
    ax.set(xlabel="collisions per disc", ylabel=label)
