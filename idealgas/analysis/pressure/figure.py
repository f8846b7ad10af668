"""Figures of the pressure: compressibility factor Z by every route, and the equation of state."""

from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from idealgas.analysis.pressure.equation_of_state import EquationOfState
from idealgas.analysis.pressure.mechanical import Mechanical
from idealgas.analysis.pressure.result import IDEAL, Pressure
from idealgas.presentation.style import BAND, BLACK, COLOURS, GREY, LINES, name_rows, panels
from idealgas.theory import hard_discs
from idealgas.theory.values import FREEZING, MELTING, PUBLISHED, SOLID


def draw_walls(result: Pressure, pressures: Mechanical) -> Figure:
    """Draw the mechanical pressure on every wall, and the external pressure on a piston."""
    figure, (ax,) = panels(1)
    walls = pressures.walls[::-1]
    values, errors = [w.pressure.value for w in walls], [w.pressure.standard_error for w in walls]
    ax.errorbar(values, range(len(walls)), xerr=errors, fmt="o", color=COLOURS[0], capsize=3, label="measured")
    for k, wall in enumerate(walls):
        ax.theory_of_row(k, wall.pressure, "external pressure")
    ideal = result.number * result.temperature / result.area
    ax.axvline(ideal, color=BLACK, linewidth=1, label=f"{IDEAL}, N T/A: {ideal:.5g}")
    name_rows(ax, [wall.name for wall in walls])
    ax.set(xlabel="P (energy/length²)", ylabel="pressure on every wall")
    figure.legend(frameon=False, fontsize="small", loc="outside lower left", ncols=2)
    return figure


def draw_routes(result: Pressure) -> Figure:
    """Draw Z of one log: every route with its error bar beside the theory of this route for the gas in its box."""
    figure, (ax,) = panels(1)
    routes = result.routes[::-1]
    values = [route.compressibility_factor.value for route in routes]
    errors = [route.compressibility_factor.standard_error for route in routes]
    known = [route.compressibility_factor.theory for route in routes]
    last = max((k for k, z in enumerate(known) if z), default=None)
    for k, route in enumerate(routes):
        label = "theory, ± its error" if k == last else None
        ax.theory_of_row(k, route.compressibility_factor, label)
    ax.errorbar(values, range(len(routes)), xerr=errors, fmt="o", color=COLOURS[0], capsize=3, label="measured")
    name_rows(ax, [route.name for route in routes])
    low, high = ax.get_xlim()
    for (name, z), style in zip(result.theories.items(), cycle(LINES), strict=False):
        shown = name == IDEAL or low < z < high
        if shown and z not in known:
            colour = BLACK if name == IDEAL else GREY
            ax.axvline(z, color=colour, linestyle=style, linewidth=1, label=f"{name}: {z:.5g}")
    ax.set(xlabel="Z = PA/NT (no unit)", ylabel=f"Z by every route, at packing fraction {result.packing_fraction:.4g}")
    figure.legend(frameon=False, fontsize="small", loc="outside lower left", ncols=2)
    return figure


def draw_states(result: EquationOfState) -> Figure:
    """Draw Z against φ with the theories, and below it the deviation of each state from its theory."""
    figure, (above, below) = panels(2)
    phi = np.array([state.packing_fraction for state in result.states])
    z = np.array([state.infinite.value for state in result.states])
    error = np.array([state.infinite.standard_error for state in result.states])
    best = np.array([state.infinite.theory or np.nan for state in result.states])
    band = 1e3 * np.array([state.infinite.theory_error for state in result.states]) / best
    x = np.linspace(1e-9, min(1.05 * phi.max(), hard_discs.HIGHEST), 400)
    curves = (
        ("virial series, resummed", hard_discs.compressibility_factor, "-", COLOURS[1]),
        ("virial series to B10", hard_discs.virial_series, "--", COLOURS[2]),
        ("Henderson 1975", hard_discs.henderson_compressibility_factor, ":", COLOURS[3]),
    )
    above.axhline(1.0, color=GREY, label="ideal gas")
    for name, function, style, colour in curves:
        above.plot(x, function(x), style, color=colour, label=name)
        below.plot(x, 1e3 * (function(x) / hard_discs.compressibility_factor(x) - 1), style, color=colour)
    if phi.max() > hard_discs.HIGHEST:
        _draw_dense(above, float(phi.max()))
    above.errorbar(phi, z, error, fmt="o", ms=4, color=COLOURS[0], label="measured")
    below.fill_between(phi, -band, band, color=COLOURS[1], alpha=BAND, linewidth=0)
    below.errorbar(phi, 1e3 * (z / best - 1), 1e3 * error / best, fmt="o", ms=4, color=COLOURS[0], capsize=3)
    if np.isfinite(best).any():
        low, high = (1e3 * (z / best - 1 + sign * 3 * error / best) for sign in (-1, 1))
        below.set_ylim(min(np.nanmin(low), 0.0), max(np.nanmax(high), 0.0))
    above.set_ylabel("Z = PA/NT (no unit)")
    below.set(ylabel="deviation from theory (‰ of Z)", xlabel="packing fraction φ (no unit)")
    below.set_xlim(above.get_xlim())
    above.legend(frameon=False, fontsize="small")
    return figure


def _draw_dense(ax: Axes, most: float) -> None:
    """Draw what is known above the range of the virial series: published points, freezing, and the crystal."""
    published, pressure = np.array(list(PUBLISHED)), np.array([value for value, _ in PUBLISHED.values()])
    points = pressure * np.pi / (4 * published)
    ax.plot(published, points, "D", ms=7, mfc="none", color=COLOURS[4], label="870 discs, Li et al. 2022")
    ax.axvspan(FREEZING, MELTING, color=GREY, alpha=0.2, label="two phases in a large gas")
    if most > SOLID:
        x = np.linspace(SOLID, min(1.01 * most, 0.99 * hard_discs.CLOSE_PACKING), 200)
        ax.plot(
            x,
            hard_discs.free_volume_compressibility_factor(x),
            "-.",
            color=COLOURS[5],
            label="free volume, of a crystal",
        )
        ax.set_yscale("log")
