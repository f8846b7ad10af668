"""Pictures of the pressure: compressibility factor Z by every route, and the equation of state."""

import numpy as np
from matplotlib.figure import Figure

from idealgas.analysis.core.style import COLOURS, GREY, _repeated, name_rows, panels
from idealgas.analysis.pressure.equation_of_state import EquationOfState
from idealgas.analysis.pressure.measure import Pressure
from idealgas.analysis.pressure.mechanical import Mechanical
from idealgas.analysis.theory import hard_discs


def pressure_figure(result: Pressure | EquationOfState) -> Figure:
    """Picture of Z of one log by every route, or of several logs against the packing fraction."""
    return _of_states(result) if isinstance(result, EquationOfState) else _of_log(result)


def _of_walls(result: Pressure, found: Mechanical) -> Figure:
    """Picture of the mechanical pressure of every wall, and of the outer pressure on a piston."""
    figure, (ax,) = panels(1)
    walls = found.walls[::-1]
    values, errors = [w.pressure.value for w in walls], [w.pressure.standard_error for w in walls]
    ax.errorbar(values, range(len(walls)), xerr=errors, fmt="o", color=COLOURS[0], capsize=3, label="measured")
    held = [(k, wall.pressure.theory) for k, wall in enumerate(walls) if wall.pressure.theory is not None]
    for k, theory in held:
        ax.plot(theory, k, "|", ms=18, color=COLOURS[1], label="outer pressure")
    name_rows(ax, [wall.name for wall in walls])
    ax.set_xlabel("P on the wall (energy/length²)")
    ax.set_ylabel("wall")
    if held:
        ax.legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(0, -0.2))
    return figure


def _of_log(result: Pressure) -> Figure:
    """Picture of Z of one log: every route with its error bar, theories as lines."""
    if result.mechanical:
        return _of_walls(result, result.mechanical)
    figure, (ax,) = panels(1)
    routes = result.routes[::-1]
    values = [route.compressibility.value for route in routes]
    errors = [route.compressibility.standard_error for route in routes]
    ax.errorbar(values, range(len(routes)), xerr=errors, fmt="o", color=COLOURS[0], capsize=3)
    name_rows(ax, [route.name for route in routes])
    for (name, theory), colour, style in zip(
        result.theories.items(), (GREY, *COLOURS[1:]), _repeated(("-", "--", ":")), strict=False
    ):
        ax.axvline(theory.value, color=colour, linestyle=style, label=f"{name}: {theory.value:.5g}")
    ax.set_xlabel(f"Z = PA/NT (no unit) at packing fraction {result.packing_fraction:.4g}")
    ax.set_ylabel("route")
    ax.legend(frameon=False, fontsize="small", loc="upper left", bbox_to_anchor=(0, -0.2))
    return figure


def _of_states(result: EquationOfState) -> Figure:
    """Picture of Z against φ with theories, and below it the deviation from the resummed virial series."""
    figure, (above, below) = panels(2)
    phi = np.array([state.packing_fraction for state in result.states])
    z = np.array([state.infinite.value for state in result.states])
    error = np.array([state.infinite.standard_error for state in result.states])
    best = hard_discs.compressibility(phi)
    x = np.linspace(1e-9, 1.05 * phi.max(), 400)
    curves = (
        ("virial series, resummed", hard_discs.compressibility, "-", COLOURS[1]),
        ("virial series to B10", hard_discs.virial_series, "--", COLOURS[2]),
        ("Henderson 1975", hard_discs.henderson_compressibility, ":", COLOURS[3]),
    )
    above.axhline(1.0, color=GREY, label="ideal gas")
    for name, function, style, colour in curves:
        above.plot(x, function(x), style, color=colour, label=name)
        below.plot(x, 1e3 * (function(x) / hard_discs.compressibility(x) - 1), style, color=colour)
    above.errorbar(phi, z, error, fmt="o", ms=4, color=COLOURS[0], label="measured")
    below.errorbar(phi, 1e3 * (z / best - 1), 1e3 * error / best, fmt="o", ms=4, color=COLOURS[0], capsize=3)
    largest = 1e3 * float((np.abs(z / best - 1) + 3 * error / best).max())
    below.set_ylim(-largest, largest)
    above.set_ylabel("Z = PA/NT (no unit), N → ∞")
    below.set_ylabel("deviation (‰ of Z)")
    below.set_xlabel("packing fraction φ (no unit)")
    above.legend(frameon=False)
    return figure
