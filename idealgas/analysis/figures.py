"""Pictures of the analyses, all alike: colours that colour-blind readers can tell apart, every axis with its unit."""

import os
from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from idealgas.analysis import theory
from idealgas.analysis.equation_of_state import EquationOfState
from idealgas.analysis.heat_capacity import HeatCapacity
from idealgas.analysis.histogram import Histogram
from idealgas.analysis.pressure import Pressure
from idealgas.analysis.temperature import Temperature
from idealgas.errors import UserError

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Okabe & Ito, Color Universal Design (2008)."""

GREY = "#767676"
LEAST_RANGE = 0.05
"""Share of itself that an axis shows of a conserved quantity: its last digits are of no interest."""


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a picture in the format that the path's ending names. Raises UserError (exit code 1) if it cannot be."""
    try:
        figure.savefig(path, dpi=150)
    except OSError as error:
        failure = UserError(f"{path}: cannot be written: {error.strerror}")
        failure.exit_code = 1
        raise failure from error


def panels(rows: int, columns: int = 1) -> tuple[Figure, list[Axes]]:
    """A figure of panels below one another, or in several columns, row by row."""
    figure = Figure(figsize=(1.5 + 5.5 * columns, 1.2 + 3.0 * rows), layout="constrained")
    axes = [figure.add_subplot(rows, columns, k + 1) for k in range(rows * columns)]
    for ax in axes:
        ax.grid(color="#dddddd", linewidth=0.6)
        ax.set_axisbelow(True)
    return figure, axes


def histogram_figure(result: Histogram) -> Figure:
    """Measured density with its error band, laws over it; one panel a species."""
    figure, axes = panels(len(result.distributions))
    for ax, found in zip(axes, result.distributions, strict=True):
        ax.stairs(found.density, found.edges, fill=True, color=COLOURS[5], alpha=0.6, label=found.name)
        middle = (found.edges[1:] + found.edges[:-1]) / 2
        ax.errorbar(middle, found.density, found.error, fmt="none", ecolor=GREY, elinewidth=0.8)
        x = np.linspace(found.edges[0], found.edges[-1], 600)
        for test, colour, style in zip(found.tests, COLOURS, ("-", "--"), strict=False):
            ax.plot(x, test.law.pdf(x), style, color=colour, label=f"{test.law_name}: KS p = {test.p_value:.2g}")
        ax.set_xlim(found.edges[0], _last_seen(found.density, found.edges))
        ax.set_xlabel(f"{result.quantity} ({result.unit})")
        ax.set_ylabel(f"density ({'time/length' if result.unit == 'length/time' else f'1/{result.unit}'})")
        ax.legend(frameon=False)
    return figure


def _last_seen(density: np.ndarray, edges: np.ndarray) -> float:
    """Edge beyond which less than 1e-3 of the largest density is found."""
    return float(edges[1 + np.flatnonzero(density > 1e-3 * density.max())[-1]])


def temperature_figure(result: Temperature) -> Figure:
    """Temperature of every species against time; the window is where it is not shaded."""
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


def pressure_figure(result: Pressure) -> Figure:
    """Z by every route with its error bar, and the theories as lines."""
    figure, (ax,) = panels(1)
    routes = result.routes[::-1]
    values = [route.compressibility.value for route in routes]
    errors = [route.compressibility.standard_error for route in routes]
    ax.errorbar(values, range(len(routes)), xerr=errors, fmt="o", color=COLOURS[0], capsize=3)
    ax.set_yticks(range(len(routes)), [route.name for route in routes])
    for (name, value), colour, style in zip(
        result.theories.items(), (GREY, *COLOURS[1:]), _repeated(("-", "--", ":")), strict=False
    ):
        ax.axvline(value, color=colour, linestyle=style, label=f"{name}: {value:.5g}")
    ax.set_xlabel(f"Z = PA/NT (no unit) at packing fraction {result.packing_fraction:.4g}")
    ax.set_ylabel("route")
    ax.legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(0, -0.2))
    return figure


def equation_of_state_figure(result: EquationOfState) -> Figure:
    """Z against φ with the theories, and below what is left when the resummed series is taken away."""
    figure, (above, below) = panels(2)
    phi = np.array([state.packing_fraction for state in result.states])
    z = np.array([state.infinite.value for state in result.states])
    error = np.array([state.infinite.standard_error for state in result.states])
    best = theory.compressibility(phi)
    x = np.linspace(1e-9, 1.05 * phi.max(), 400)
    curves = (
        ("virial series, resummed", theory.compressibility, "-", COLOURS[1]),
        ("virial series to B10", theory.virial_series, "--", COLOURS[2]),
        ("Henderson 1975", theory.henderson_compressibility, ":", COLOURS[3]),
    )
    above.axhline(1.0, color=GREY, label="ideal gas")
    for name, function, style, colour in curves:
        above.plot(x, function(x), style, color=colour, label=name)
        below.plot(x, 1e3 * (function(x) / theory.compressibility(x) - 1), style, color=colour)
    above.errorbar(phi, z, error, fmt="o", ms=4, color=COLOURS[0], label="measured")
    below.errorbar(phi, 1e3 * (z / best - 1), 1e3 * error / best, fmt="o", ms=4, color=COLOURS[0], capsize=3)
    largest = 1e3 * float((np.abs(z / best - 1) + 3 * error / best).max())
    below.set_ylim(-largest, largest)
    above.set_ylabel("Z = PA/NT (no unit), N → ∞")
    below.set_ylabel("deviation (‰ of Z)")
    below.set_xlabel("packing fraction φ (no unit)")
    above.legend(frameon=False)
    return figure


def heat_capacity_figure(result: HeatCapacity) -> Figure:
    """C per disc (and γ) by every route with its error bar, and the theory beside it."""
    figure, (ax,) = panels(1)
    routes = result.routes[::-1]
    for k, route in enumerate(routes):
        ax.errorbar(route.value.value, k, xerr=route.value.standard_error, fmt="o", color=COLOURS[0], capsize=3)
        if route.value.theory is not None:
            ax.plot([route.value.theory] * 2, [k - 0.35, k + 0.35], color=COLOURS[1])
    ax.set_yticks(range(len(routes)), [f"{route.name}\n({route.kind})" for route in routes], fontsize="small")
    ax.plot([], [], "o", color=COLOURS[0], label="measured")
    ax.plot([], [], color=COLOURS[1], label="theory")
    ax.set_xlabel("C/N, and γ (no unit, k_B = 1)")
    ax.set_ylabel("route")
    ax.legend(frameon=False)
    figure.set_figheight(1.5 + 0.55 * len(routes))
    return figure


def _repeated(items: tuple[str, ...]) -> Iterable[str]:
    while True:
        yield from items
