"""Cost estimate of a sweep before it is run."""

import math
import tempfile
from pathlib import Path
from typing import NamedTuple

from idealgas.analysis.theory.forecast import BYTES_A_ROW, forecast
from idealgas.initial.build import make_gas
from idealgas.run.simulate import simulate
from idealgas.scene import Scene
from idealgas.sweep.plan import Sweep

TRIAL_EVENTS = 20_000  # events of the short runs that measure the speed
ALONE = 0.05  # seconds that every point takes for its log, its analyses and the scheduler


class Cost(NamedTuple):
    """Cost estimate of one point of a sweep.

    number: of discs. packing_fraction: no unit. events: number of events. bytes: size of the log. seconds: run time.
    """

    number: int
    packing_fraction: float
    events: float
    bytes: float
    seconds: float


class _Trial(NamedTuple):
    """Short run of a scene: event rows in the log per event, events per second, and events per simulated time."""

    rows: float
    per_second: float
    per_time: float


def estimate_cost(sweep: Sweep) -> tuple[Cost, ...]:
    """Cost estimate of each point, from a short run of each combination of values and, where possible, from theory."""
    trials: dict[int, _Trial] = {}
    costs = []
    for point in sweep.points:
        if point.combination not in trials:
            trials[point.combination] = _try(point.scene)
        costs.append(_cost(point.scene, trials[point.combination]))
    return tuple(costs)


def _cost(scene: Scene, trial: _Trial) -> Cost:
    expected = forecast(scene, make_gas(scene))
    events, size = expected.events, expected.bytes
    if events is None:
        until = scene.run.until or math.inf
        collisions = (scene.run.collisions_per_disc or math.inf) * expected.number / 2  # events, if walls are far
        events = min(scene.run.events or math.inf, collisions, trial.per_time * until)
    if size is None:
        size = events * trial.rows * BYTES_A_ROW[scene.log.compression]
    return Cost(expected.number, expected.packing_fraction, events, size, ALONE + events / trial.per_second)


def _try(scene: Scene) -> _Trial:
    run = scene.run.model_copy(update={"events": min(TRIAL_EVENTS, scene.run.events or TRIAL_EVENTS)})
    with tempfile.TemporaryDirectory(prefix="idealgas-sweep-") as folder:
        summary = simulate(scene.model_copy(update={"run": run}), Path(folder) / "trial.h5")
    events = max(summary.events, 1)
    return _Trial(summary.rows / events, events / summary.seconds, events / max(summary.end_time, 1e-300))
