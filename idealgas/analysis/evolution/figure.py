"""Picture of the evolution of a gas in time."""

from matplotlib.figure import Figure

from idealgas.analysis.core.style import COLOURS, GREY, panels
from idealgas.analysis.evolution.measure import Evolution


def evolution_figure(result: Evolution) -> Figure:
    """Picture of the temperature, its law dashed, and of discs beyond a gate, piston and energy given by walls."""
    shown = [result.beyond, result.piston is not None, result.given]
    figure, axes = panels(1 + sum(map(bool, shown)))
    _temperature(axes[0], result)
    rest = iter(axes[1:])
    if result.beyond:
        ax = next(rest)
        for (name, share), colour in zip(result.beyond.items(), COLOURS * len(result.beyond), strict=False):
            ax.plot(result.time, share, color=colour, label=name)
        ax.set_ylim(-0.05, 1.05)
        ax.set_ylabel("share beyond the gate (no unit)")
    if result.piston is not None:
        ax = next(rest)
        ax.plot(result.samples, result.piston, "o-", ms=3, color=COLOURS[0], label="piston")
        if result.law is not None and result.law.piston is not None:
            ax.axhline(result.law.piston, color=GREY, linestyle="--", label="theory")
        ax.set_ylabel("place of the piston (length)")
    if result.given:
        ax = next(rest)
        for (name, energy), colour in zip(result.given.items(), COLOURS * len(result.given), strict=False):
            ax.plot(result.samples, energy, "o-", ms=3, color=colour, label=f"given by: {name}")
        ax.set_ylabel("energy (k_B = 1)")
    for ax in axes:
        ax.set_xlabel("t (time)")
        ax.legend(frameon=False, fontsize="small")
    return figure


def _temperature(ax, result: Evolution) -> None:  # type: ignore[no-untyped-def]
    ax.plot(result.time, result.temperature, color=COLOURS[0], label="m v²/2 a disc")
    if result.spin is not None:
        ax.plot(result.time, result.spin, color=COLOURS[1], label="I ω² a disc")
    if result.law is not None:
        ax.plot(result.time, result.law.temperature, "--", color=GREY, label=result.law.text)
    low, high = result.temperature.min(), result.temperature.max()
    if high > 10 * low > 0:
        ax.set_yscale("log")
    elif high - low < 1e-6 * high:  # changes only by rounding
        ax.set_ylim(0.9 * low, 1.1 * high)
    ax.set_ylabel("temperature (energy, k_B = 1)")
