"""Picture of the transport in a gas."""

import numpy as np
from matplotlib.figure import Figure

from idealgas.analysis.core.style import COLOURS, GREY, panels
from idealgas.analysis.transport.measure import Transport


def transport_figure(result: Transport) -> Figure:
    """Picture of velocity correlation, mean square displacement and pair distribution."""
    figure, (correlation, displacement, pairs) = panels(3)
    for entry, colour in zip(result.diffusion, COLOURS * len(result.diffusion), strict=False):
        correlation.errorbar(entry.lag, entry.correlation, entry.correlation_error, color=colour, label=entry.species)
        if entry.coefficient.theory is not None and entry.tail is not None:
            rate = result.free_paths[0].time.value ** -1
            correlation.plot(entry.lag, np.exp(-rate * entry.lag), "--", color=GREY, label="Enskog: exp(-Γt)")
            late = rate * entry.lag > 5
            correlation.plot(entry.lag[late], entry.tail[late], ":", color=COLOURS[1], label="tail 1/(8πn(D + ν)t)")
        displacement.errorbar(
            entry.lag, entry.displacement, entry.displacement_error, color=colour, label=f"{entry.species}, measured"
        )
        d = entry.coefficient.value
        displacement.plot(entry.lag, 4 * d * entry.lag, "--", color=GREY, label=f"4Dt, D = {d:.4g}")
    correlation.set_yscale("symlog", linthresh=1e-3)
    for found, colour in zip(result.pair_distributions, COLOURS * len(result.pair_distributions), strict=False):
        middle = (found.edges[1:] + found.edges[:-1]) / 2
        label = f"{found.species} and {found.other}"
        pairs.errorbar(middle, found.value, found.error, fmt=".", ms=3, color=colour, label=label)
        for contact in result.contacts:
            if (contact.species, contact.other) == (found.species, found.other):
                pairs.plot(found.edges[0], contact.value.value, "D", color=colour, label=f"{label}: by collisions")
    pairs.axhline(1.0, color=GREY, linewidth=0.8)
    for ax, x, y in (
        (correlation, "t (time)", "⟨v(0)·v(t)⟩/⟨v²⟩ (no unit)"),
        (displacement, "t (time)", "mean square displacement (length²)"),
        (pairs, "r (length)", "g(r) (no unit)"),
    ):
        ax.set_xlabel(x)
        ax.set_ylabel(y)
        ax.legend(frameon=False, fontsize="small")
    return figure
