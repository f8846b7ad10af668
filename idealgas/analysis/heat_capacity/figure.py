"""Picture of heat capacities: C per disc by every route, compared with theory."""

from matplotlib.figure import Figure

from idealgas.analysis.core.style import COLOURS, name_rows, panels
from idealgas.analysis.heat_capacity.combine import HeatCapacity


def heat_capacity_figure(result: HeatCapacity) -> Figure:
    """Picture of C per disc (and of γ) by every route with its error bar, and of its theory."""
    figure, (ax,) = panels(1)
    routes = result.routes[::-1]
    for k, route in enumerate(routes):
        ax.errorbar(route.value.value, k, xerr=route.value.standard_error, fmt="o", color=COLOURS[0], capsize=3)
        if route.value.theory is not None:
            ax.plot([route.value.theory] * 2, [k - 0.35, k + 0.35], color=COLOURS[1])
    kinds = [", ".join(filter(None, (route.kind, route.gas))) for route in routes]
    names = [f"{kind}: {route.name}" if kind else route.name for kind, route in zip(kinds, routes, strict=True)]
    name_rows(ax, [name.replace(" of the kinetic energy", "") for name in names], fontsize="small")
    ax.locator_params(axis="x", nbins=6)
    ax.plot([], [], "o", color=COLOURS[0], label="measured")
    ax.plot([], [], color=COLOURS[1], label="theory")
    ax.set_xlabel("C/N, and γ (no unit, k_B = 1)")
    ax.set_ylabel("by every route")
    ax.legend()
    figure.set_figheight(1.5 + 0.3 * len(routes))
    return figure
