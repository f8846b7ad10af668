"""Draw the speed of the engine: collisions per second, and time per collision, against the number of discs."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from idealgas.bench.bench import Bench
from idealgas.presentation.style import COLOURS, GREY, panels

MARKERS = "osD^vP"
MILLION, MICRO = 1e-6, 1e6


class Peer(NamedTuple):
    """Stated speed of another program.

    Attributes:
        name: name of the program.
        phi: packing fraction.
        rates: collisions per second, by number of discs.
        source: source of these numbers.
    """

    name: str
    phi: float
    rates: dict[int, float]
    source: str


PEERS = (
    Peer(
        "billiards (C++)",
        0.1,
        {1_000: 0.15e6, 10_000: 0.09e6, 100_000: 0.05e6},
        "measured on one core, alternating with idealgas",
    ),
)
"""Other programs; their speeds were not measured by this benchmark."""


def bench_figure(bench: Bench) -> Figure:
    """Return a figure of collisions per second and time per collision against N, without the log.

    There is a curve for each packing fraction and number of threads.
    """
    figure, (rates, times) = panels(1, 2)
    series: dict[tuple[float, int], dict[int, float]] = {}
    for row in bench.rows:
        if not row.log:
            series.setdefault((row.phi, row.threads), {})[row.N] = row.collisions_per_s
    colour = dict(zip(sorted({phi for phi, _ in series}), COLOURS, strict=False))
    marker = dict(zip(sorted({threads for _, threads in series}), MARKERS, strict=False))

    def draw(speeds: dict[int, float], label: str, **style: Any) -> None:
        n, rate = list(speeds), np.array(list(speeds.values()))
        rates.plot(n, MILLION * rate, label=label, **style)
        times.plot(n, MICRO / rate, **style)

    for (phi, threads), entries in series.items():
        line = "-" if threads == 1 else "--"
        style = {"color": colour.get(phi, GREY), "marker": marker.get(threads, "."), "ls": line}
        draw(entries, f"φ = {phi:g}, {threads} thread{'s' * (threads > 1)}", **style)
    for peer in PEERS:
        label = f"{peer.name}, φ = {peer.phi:g},\n{peer.source}"
        draw(peer.rates, label, color=GREY, marker="x", ls=":")
    for ax, name in ((rates, "million collisions per second"), (times, "time per collision (µs)")):
        ax.set(xscale="log", yscale="log", xlabel="number of discs N", ylabel=name)
        ax.yaxis.set_major_formatter("{x:g}")
    figure.suptitle("Speed of the event-driven engine: reflecting box, equal discs, without the log")
    figure.legend(*rates.get_legend_handles_labels(), loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    return figure
