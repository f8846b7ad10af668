"""Picture of the profiles of density and temperature."""

import numpy as np
from matplotlib.figure import Figure

from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.style import BLACK, Panel, Strips, curve_style, panels
from idealgas.analysis.profile.measure import Profile


def profile_figure(result: Profile) -> Figure:
    """Picture of density and temperature against position, theory dashed; spin temperature as crosses."""
    figure, (density, temperature) = panels(2)
    for k, entry in enumerate(result.species):
        colour, _, marker = curve_style(k)
        points = {"fmt": marker, "ms": 4, "color": colour, "capsize": 2}
        _draw(density, result, entry.density, points | {"label": entry.species})
        _draw(temperature, result, entry.temperature, points | {"label": f"{entry.species}: m v²/2"})
        if entry.spin is not None:
            _draw(temperature, result, entry.spin, points | {"fmt": "x", "label": f"{entry.species}: I ω²"})
    if result.law is not None:
        density.plot([], [], "--", color=BLACK, label=f"theory: {result.law}")
        highest = [e.theory or 0.0 for entry in result.species for e in entry.density]
        if max(highest) > 20 * min(highest) > 0:
            density.set_yscale("log")
    for ax in (density, temperature):
        ax.set_xlabel(f"{result.axis} (length)")
        ax.legend()
    low, high, number = result.edges[0], result.edges[-1], len(result.middles)
    density.strips = Strips("xy".index(result.axis), float(low), float(high), number, result.strip)
    density.set_ylabel("n (1/length²)")
    temperature.set_ylabel("temperature (energy, k_B = 1)")
    return figure


def _draw(ax: Panel, result: Profile, column: tuple[Estimate, ...], style: dict) -> None:
    value, error = (np.array([getattr(e, name) for e in column]) for name in ("value", "standard_error"))
    theory = np.array([np.nan if e.theory is None else e.theory for e in column])
    ax.plot(result.middles, theory, "--", color=BLACK, linewidth=0.9, zorder=3)
    ax.errorbar(result.middles, value, error, **style)
