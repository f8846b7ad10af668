"""Picture of the order of discs."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from idealgas.analysis.core.style import COLOURS, GREY, panels
from idealgas.analysis.order.measure import Order
from idealgas.analysis.order.structure import Structure


def order_figure(result: Order) -> Figure:
    """Picture of hexagonal order against time and distance; in a periodic box of S against wave number and vector."""
    figure, axes = panels(1 if result.structure is None else 2, 2)
    series, correlation = axes[:2]
    series.plot(result.time, result.series, color=COLOURS[0], label="measured")
    series.axvspan(result.window.start, result.window.end, color=GREY, alpha=0.12, label="window of the averages")
    series.time_axis()
    series.set(ylim=(0, 1), ylabel="|Ψ₆| of all discs (no unit)")
    x, y, error = result.distance, result.correlation, result.correlation_error
    correlation.errorbar(x, y, error, fmt=".", ms=3, color=COLOURS[0], label="measured")
    correlation.axhline(result.whole.value**2, color=GREY, linewidth=0.9, label="|Ψ₆|² (no correlation left)")
    correlation.set(xlabel="r (length)", ylabel="g₆(r) (no unit)", ylim=(None, None if result.whole.value < 0.5 else 1))
    if result.structure is not None:
        _draw_rings(axes[2], result.structure, result.compressibility)
        _draw_vectors(axes[3], result.structure)
    for ax in axes[:3]:
        ax.legend()
    return figure


def _draw_rings(ax: Axes, found: Structure, limit: float | None) -> None:
    """Draw S against the wave number, with its limit at small k by theory."""
    ax.errorbar(found.k, found.value, found.error, fmt=".", ms=4, color=COLOURS[0], label="mean over directions")
    if limit is not None:
        ax.axhline(limit, color=GREY, linestyle="--", linewidth=0.9, label="theory for small k: compressibility")
    ax.set(yscale="log", xlabel="k (1/length)", ylabel="S(k) (no unit)", xlim=(0, None))


def _draw_vectors(ax: Axes, found: Structure) -> None:
    """Draw S at every wave vector, in all directions."""
    half = found.on_lattice
    both = np.concatenate((half[:0:-1, ::-1], half))
    both[len(half) - 1] = np.fmax(half[0], half[0, ::-1])
    kx = np.concatenate((-found.kx[:0:-1], found.kx))
    low, high = np.nanmin(half), np.nanmax(half)
    shown = ax.pcolormesh(
        kx, found.ky, both.T, norm=LogNorm(max(low, high * 1e-4), high), cmap="cividis", rasterized=True
    )
    ax.set(aspect="equal", xlabel="kx (1/length)", ylabel="ky (1/length)")
    ax.grid(visible=False)
    ax.figure.colorbar(shown, ax=ax, label="S(k) (no unit)")
