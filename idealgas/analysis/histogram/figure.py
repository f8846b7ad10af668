"""Picture of a histogram: measured probability densities and their laws."""

import numpy as np
from matplotlib.figure import Figure

from idealgas.analysis.core.style import COLOURS, GREY, panels
from idealgas.analysis.histogram.measure import Histogram


def histogram_figure(result: Histogram) -> Figure:
    """Picture of the measured density with its error band and of the laws; one panel for each species."""
    figure, axes = panels(len(result.distributions))
    for ax, found in zip(axes, result.distributions, strict=True):
        name = f"{found.name} (no law)" if result.no_law else found.name
        ax.stairs(found.density, found.edges, fill=True, color=COLOURS[5], alpha=0.6, label=name)
        middle = (found.edges[1:] + found.edges[:-1]) / 2
        ax.errorbar(middle, found.density, found.error, fmt="none", ecolor=GREY, elinewidth=0.8)
        x = np.linspace(found.edges[0], found.edges[-1], 600)
        for test, colour, style in zip(found.tests, COLOURS, ("-", "--"), strict=False):
            ax.plot(x, test.law.pdf(x), style, color=colour, label=f"{test.law_name}: KS p = {test.p_value:.2g}")
        ax.set_xlim(found.edges[0], _last_seen(found.density, found.edges))
        ax.set_xlabel(f"{result.quantity} ({result.unit})")
        ax.set_ylabel(f"density ({'time/length' if result.unit == 'length/time' else f'1/{result.unit}'})")
        ax.legend()
    return figure


def _last_seen(density: np.ndarray, edges: np.ndarray) -> float:
    """Edge of the bins beyond which the density is less than 1e-3 of its maximum."""
    return float(edges[1 + np.flatnonzero(density > 1e-3 * density.max())[-1]])
