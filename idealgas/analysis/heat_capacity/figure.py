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
    names = [f"{route.name}\n({', '.join(filter(None, (route.kind, route.gas)))})" for route in routes]
    name_rows(ax, names, fontsize="small")
    ax.plot([], [], "o", color=COLOURS[0], label="measured")
    ax.plot([], [], color=COLOURS[1], label="theory")
    ax.set_xlabel("C/N, and γ (no unit, k_B = 1)")
    ax.set_ylabel("heat capacity by every route")
    ax.legend()
    figure.set_figheight(1.5 + 0.55 * len(routes))
    return figure
