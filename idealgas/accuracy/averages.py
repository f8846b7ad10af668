"""Measure averages of a scene in one case: collision rate, pressure, speed distribution, energy drift and overlap."""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from idealgas.analysis.histogram import HistogramAnalysis
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.pressure.result import Pressure
from idealgas.analysis.pressure.routes import PAIRS, WALLS
from idealgas.errors import UserError
from idealgas.log import Log, open_log
from idealgas.log.summary import Summary
from idealgas.run.simulate import simulate
from idealgas.scene import Scene
from idealgas.statistics.estimates import Estimate


@dataclass(frozen=True)
class Averages:
    """Averages over the equilibrium window of a run; a quantity that does not apply is None.

    Attributes:
        rate: number of pair collisions in the gas per time.
        z_pairs: Z = PA/NT from the virial of the pairs, with its theoretical value.
        z_walls: Z = PA/NT from the virial of the walls, with its theoretical value.
        distance: Kolmogorov-Smirnov distance between the distribution of speeds and the theoretical distribution.
        noise: value of this distance that is expected by chance.
        drift: relative change in the energy.
        overlap: deepest overlap, relative to the sum of the two radii.
        window: start of the window, time.
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
    """Run a scene to its end and measure its averages.

    Args:
        scene: the scene.
        path: path of the log, which is removed afterwards.
        window: start of the window, time; None to detect when equilibrium is reached.
        progress: function that is called with the fraction of the work that is done.

    Returns:
        Averages, and the summary of the run.
    """
    summary = simulate(scene, path, force=True, on_progress=lambda p: progress(p.share))
    with open_log(path) as log:
        averages = _averages(log, summary, window)
    path.unlink()
    return averages, summary


def _averages(log: Log, summary: Summary, window: float | None) -> Averages:
    distance = noise = None
    with suppress(UserError):
        speeds = HistogramAnalysis.measure(log, "speed", window).distributions
        worst = max(speeds, key=lambda distribution: distribution.tests[-1].distance)
        distance, noise = worst.tests[-1].distance, 0.87 / math.sqrt(worst.samples)  # mean under Kolmogorov's law
    try:
        measured = pressure(log, window)
    except UserError:  # the analysis does not apply to this gas; its collisions are counted instead
        count = summary.disc_collisions
        rate = Estimate(count / summary.end_time, math.sqrt(count) / summary.end_time, count)
        return Averages(rate, None, None, distance, noise, summary.energy_drift, summary.deepest_overlap, None)
    routes = {route.name: route.compressibility_factor for route in measured.routes}
    return Averages(
        rate=_total_rate(measured, log),
        z_pairs=routes[PAIRS],
        z_walls=next((z for name, z in routes.items() if name.startswith(WALLS)), None),
        distance=distance,
        noise=noise,
        drift=summary.energy_drift,
        overlap=summary.deepest_overlap,
        window=measured.window.start,
    )


def _total_rate(measured: Pressure, log: Log) -> Estimate:
    """Return the number of pair collisions of the whole gas per time; each pair of species counts once."""
    number = {name: int((log.discs.species == k).sum()) for k, name in enumerate(log.discs.species_names)}
    value = variance = 0.0
    seen: set[frozenset[str]] = set()
    for entry in measured.collision_rates:
        if (pair := frozenset((entry.species, entry.other))) not in seen:
            seen.add(pair)
            discs = number[entry.species] * (0.5 if len(pair) == 1 else 1.0)
            value += discs * entry.rate.value
            variance += (discs * entry.rate.standard_error) ** 2
    return Estimate(value, math.sqrt(variance), math.inf)
