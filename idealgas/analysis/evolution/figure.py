"""Picture of the evolution of a gas in time."""

import numpy as np
from matplotlib.figure import Figure

from idealgas.analysis.core.style import BLACK, COLOURS, GREY, Panel, curve_style, panels
from idealgas.analysis.evolution.measure import Evolution, source_label
from idealgas.analysis.evolution.pressure_series import PressureSeries
from idealgas.analysis.evolution.theory import Law

WIDER = 1.2
"""Range of the areas at which isotherm and adiabat are drawn, in units of that of the gas."""


def evolution_figure(result: Evolution) -> Figure:
    """Picture of the temperature, its law dashed, of discs beyond a gate, pressure, piston and energy from walls.

    With a piston the pressure against the area comes last, with the isotherm and the adiabat through the start.
    """
    series, has_piston = result.pressure, result.track is not None
    shown = [result.beyond, series, has_piston, result.given, series and has_piston]
    figure, axes = panels(1 + sum(map(bool, shown)))
    _temperature(axes[0], result)
    rest = iter(axes[1:])
    if result.beyond:
        ax = next(rest)
        for k, (name, share) in enumerate(result.beyond.items()):
            colour, line, _ = curve_style(k)
            ax.plot(result.time, share, line, color=colour, label=name)
        ax.set_ylim(-0.05, 1.05)
        ax.set_ylabel("fraction beyond the gate (no unit)")
    if series:
        _pressure(next(rest), series, result.law)
    if result.track:
        ax = next(rest)
        ax.plot(*result.track, color=COLOURS[0], label="piston")
        if result.law is not None and result.law.piston is not None:
            place = result.law.piston
            ax.axhline(place, color=BLACK, linestyle="--", label=f"theory: at rest at {place:.4g}")
        ax.set_ylabel("piston position (length)")
    if result.given:
        ax = next(rest)
        for k, (name, energy) in enumerate(result.given.items()):
            colour, line, marker = curve_style(k)
            ax.plot(result.samples, energy, line, marker=marker, ms=3, color=colour, label=source_label(name))
        ax.set_ylabel("energy (k_B = 1)")
    for ax in axes:
        ax.time_axis()
    if series and has_piston:
        _state(next(rest), series)
    for ax in axes:
        ax.legend()
    return figure


def _temperature(ax: Panel, result: Evolution) -> None:
    ax.plot(result.time, result.temperature, color=COLOURS[0], label="kinetic energy per disc")
    if result.spin is not None:
        ax.plot(result.time, result.spin, color=COLOURS[1], label="I ω² per disc")
    if result.law is not None:
        ax.plot(result.time, result.law.temperature, "--", color=BLACK, label=result.law.text)
    low, high = result.temperature.min(), result.temperature.max()
    if high > 10 * low > 0:
        ax.set_yscale("log")
    elif high - low < 1e-6 * high:  # changes only by rounding
        ax.set_ylim(0.9 * low, 1.1 * high)
    ax.set_ylabel("temperature (energy, k_B = 1)")


def _pressure(ax: Panel, series: PressureSeries, law: Law | None) -> None:
    """Pressure against time, and the outer pressure on a piston, or the adiabat of a piston that is moved."""
    for name, colour in zip(series.shown, COLOURS, strict=False):
        p, error = series.pressure[name], series.error[name]
        ax.errorbar(series.middles, p, error, fmt="o", ms=3, color=colour, elinewidth=0.8, label=f"P on {name}")
    if law and law.pressure:
        ax.axhline(law.pressure, ls="--", color=BLACK, label="theory: outer pressure")
    elif law and series.lines and series.lines.adiabat is not None:
        adiabat = np.interp(series.area, series.lines.area, series.lines.adiabat)
        ax.plot(series.middles, adiabat, "--", color=BLACK, label="theory: adiabat")
    ax.set_ylabel("pressure (energy/length²)")


def _state(ax: Panel, series: PressureSeries) -> None:
    """Pressure against area, in order of time, with isotherm and adiabat."""
    for name, colour in zip(series.shown, COLOURS, strict=False):
        p, error = series.pressure[name], series.error[name]
        ax.errorbar(series.area, p, error, fmt="o-", ms=3, lw=0.5, color=colour, elinewidth=0.8, label=f"P on {name}")
    if lines := series.lines:
        middle = series.area.mean()
        near = np.abs(lines.area - middle) <= WIDER * np.abs(series.area - middle).max()
        ax.plot(lines.area[near], lines.isotherm[near], "--", color=GREY, label="isotherm through the start")
        if lines.adiabat is not None:
            ax.plot(lines.area[near], lines.adiabat[near], "-", color=GREY, label="adiabat through the start")
    ax.in_time = False
    ax.set_xlabel("area of the gas (length²)")
    ax.set_ylabel("pressure (energy/length²)")
