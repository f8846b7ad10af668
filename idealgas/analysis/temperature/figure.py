"""Picture of the temperature of every species, or of both directions, against time."""

from matplotlib.figure import Figure

from idealgas.analysis.core.style import BLACK, GREY, curve_style, panels
from idealgas.analysis.temperature.measure import Temperature

LEAST_RANGE = 0.05
"""Smallest relative range of the temperature axis, so that rounding of a conserved quantity is not visible."""


def temperature_figure(result: Temperature) -> Figure:
    """Picture of the temperature against time: of every species, or along x and y; before the window it is shaded."""
    figure, (ax,) = panels(1)
    edges = result.window.edges
    if len(result.apart) == 1:
        x, y = result.apart[0].directions.T
        curves = {"m vx²": x, "m vy²": y}
    else:
        curves = {f"{entry.species} (N = {entry.number})": entry.history for entry in result.apart}
    for k, (name, values) in enumerate(curves.items()):
        colour, line, _ = curve_style(k)
        ax.stairs(values, edges, baseline=None, color=colour, linestyle=line, linewidth=0.9, label=name)
    if result.expected is not None:
        ax.axhline(result.expected, color=BLACK, linestyle="--", label="theory: E/N")
    if result.window.first:
        ax.axvspan(edges[0], result.window.start, color=GREY, alpha=0.2, linewidth=0, label="left out")
    ax.time_axis()
    ax.set_ylabel("temperature (energy, k_B = 1)")
    ax.ticklabel_format(useOffset=False)
    low, high = ax.get_ylim()
    middle, reach = (low + high) / 2, max(high - low, LEAST_RANGE * (low + high)) / 2
    ax.set_ylim(middle - reach, middle + reach)
    ax.legend()
    return figure
