"""Averages of a scene in one case: collision rate, pressure, speed distribution, energy drift and overlap."""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.histogram import HistogramAnalysis
from idealgas.analysis.pressure.measure import PAIRS, WALLS, Pressure, pressure
from idealgas.errors import UserError
from idealgas.log import Log, open_log
from idealgas.log.summary import Summary
from idealgas.run.simulate import simulate
from idealgas.scene import Scene


@dataclass(frozen=True)
class Averages:
    """Averages of a scene's run over its equilibrium window; None where a quantity does not apply.

    rate: pair collisions of the gas per time. z_pairs, z_walls: Z = PA/NT by the virial of the pairs and of the walls,
    with theory. distance: Kolmogorov-Smirnov distance of the speeds from their distribution. noise: its expected value
    by chance. drift: relative change of the energy. overlap: deepest overlap in units of the sum of two radii. window:
    start of the window, time.
    """

    rate: Estimate
    z_pairs: Estimate | None
    z_walls: Estimate | None
    distance: float | None
    noise: float | None
    drift: float | None
    overlap: float
    window: float | None


def measure_averages(
    scene: Scene, path: Path, window: float | None, progress: Callable[[float], None]
) -> tuple[Averages, Summary]:
    """Run a scene to its end and measure its averages; the log at `path` is removed afterwards.

    window: start of the window, time; None to detect equilibrium. progress: called with the fraction done.
    """
    summary = simulate(scene, path, force=True, on_progress=lambda p: progress(p.share))
    with open_log(path) as log:
        found = _averages(log, summary, window)
    path.unlink()
    return found, summary


def _averages(log: Log, summary: Summary, window: float | None) -> Averages:
    distance = noise = None
    with suppress(UserError):
        worst = max(
            HistogramAnalysis.measure(log, "speed", window).distributions, key=lambda found: found.tests[-1].distance
        )
        distance, noise = worst.tests[-1].distance, 0.87 / math.sqrt(worst.samples)  # mean of Kolmogorov's distribution
    try:
        found = pressure(log, window)
    except UserError:  # not applicable to this gas: only count collisions
        count = summary.disc_collisions
        rate = Estimate(count / summary.end_time, math.sqrt(count) / summary.end_time, count)
        return Averages(rate, None, None, distance, noise, summary.energy_drift, summary.deepest_overlap, None)
    routes = {route.name: route.compressibility_factor for route in found.routes}
    return Averages(
        rate=_total_rate(found, log),
        z_pairs=routes[PAIRS],
        z_walls=next((z for name, z in routes.items() if name.startswith(WALLS)), None),
        distance=distance,
        noise=noise,
        drift=summary.energy_drift,
        overlap=summary.deepest_overlap,
        window=found.window.start,
    )


def _total_rate(found: Pressure, log: Log) -> Estimate:
    """Pair collisions of the whole gas per time; each pair of species counts once."""
    number = {name: int((log.discs.species == k).sum()) for k, name in enumerate(log.discs.species_names)}
    value = variance = 0.0
    seen: set[frozenset[str]] = set()
    for entry in found.collision_rates:
        if (pair := frozenset((entry.species, entry.other))) not in seen:
            seen.add(pair)
            discs = number[entry.species] * (0.5 if len(pair) == 1 else 1.0)
            value += discs * entry.rate.value
            variance += (discs * entry.rate.standard_error) ** 2
    return Estimate(value, math.sqrt(variance), math.inf)
