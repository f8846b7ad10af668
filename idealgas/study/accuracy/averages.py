"""What averages of a scene come out as on a rung, beside those of the event-driven run and beside theory."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.histogram.measure import histogram
from idealgas.analysis.pressure.measure import PAIRS, WALLS, Pressure, pressure
from idealgas.errors import UserError
from idealgas.log import Log, open_log
from idealgas.run.simulate import Summary, simulate
from idealgas.scene import Scene


@dataclass(frozen=True)
class Averages:
    """From a whole run of the scene, in its window of equilibrium; None where this gas has no such thing.

    rate: pair collisions per time. z_pairs, z_walls: PA/NT by either virial, with theory. distance: of Kolmogorov and
    Smirnov, from the law of speeds; noise: what chance makes of it. drift: of the energy, relative. overlap: deepest,
    of the sum of the radii. window: time at which it starts.
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
    """Run a scene to its end, into a log at `path` that is there only meanwhile.

    window: where it starts, so that all rungs have the same; if None, at detected equilibrium.
    """
    summary = simulate(scene, path, force=True, on_progress=lambda p: progress(p.share))
    with open_log(path) as log:
        found = _averages(log, summary, window)
    path.unlink()
    return found, summary


def _averages(log: Log, summary: Summary, window: float | None) -> Averages:
    distance = noise = None
    try:
        speeds = histogram(log, "speed", window)
    except UserError:
        pass
    else:
        max_errors = max(speeds.distributions, key=lambda found: found.tests[-1].distance)
        distance, noise = (
            max_errors.tests[-1].distance,
            0.87 / math.sqrt(max_errors.samples),
        )  # mean of Kolmogorov's distribution
    try:
        found = pressure(log, window)
    except UserError:  # this gas has no theory: what can be counted
        count = summary.disc_collisions
        rate = Estimate(count / summary.end_time, math.sqrt(count) / summary.end_time, count)
        return Averages(rate, None, None, distance, noise, summary.energy_drift, summary.deepest_overlap, None)
    routes = {route.name: route.compressibility for route in found.routes}
    return Averages(
        rate=_total_rate(found, log),
        z_pairs=routes[PAIRS],
        z_walls=routes.get(WALLS),
        distance=distance,
        noise=noise,
        drift=summary.energy_drift,
        overlap=summary.deepest_overlap,
        window=found.window.start,
    )


def _total_rate(found: Pressure, log: Log) -> Estimate:
    """Pair collisions of the gas per time; each pair of species counts once."""
    number = {name: int((log.discs.species == k).sum()) for k, name in enumerate(log.discs.species_names)}
    value = variance = 0.0
    seen: set[frozenset[str]] = set()
    for entry in found.collision_rates:
        if (pair := frozenset((entry.species, entry.other))) not in seen:
            seen.add(pair)
            share = number[entry.species] * (0.5 if len(pair) == 1 else 1.0)
            value += share * entry.rate.value
            variance += (share * entry.rate.standard_error) ** 2
    return Estimate(value, math.sqrt(variance), math.inf)
