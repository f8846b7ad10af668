"""Picture of the temperature of every species against time."""

from matplotlib.figure import Figure

from idealgas.analysis.core.style import COLOURS, GREY, _repeated, panels
from idealgas.analysis.temperature.measure import Temperature

LEAST_RANGE = 0.05
"""Smallest relative range of the temperature axis, so that rounding of a conserved quantity is not visible."""


def temperature_figure(result: Temperature) -> Figure:
    """Picture of the temperature of every species against time; the time before the window is shaded."""
    figure, (ax,) = panels(1)
    edges = result.window.edges
    for entry, colour in zip(result.apart, _repeated(COLOURS), strict=False):
        ax.stairs(entry.history, edges, baseline=None, color=colour, label=f"{entry.species} (N = {entry.number})")
    if result.expected is not None:
        ax.axhline(result.expected, color=GREY, linestyle="--", label="E/N")
    if result.window.first:
        ax.axvspan(edges[0], result.window.start, color=GREY, alpha=0.2, linewidth=0, label="left out")
    ax.set_xlabel("t (time)")
    ax.set_ylabel("temperature (energy, k_B = 1)")
    ax.ticklabel_format(useOffset=False)
    low, high = ax.get_ylim()
    middle, reach = (low + high) / 2, max(high - low, LEAST_RANGE * (low + high)) / 2
    ax.set_ylim(middle - reach, middle + reach)
    ax.legend(frameon=False)
    return figure
