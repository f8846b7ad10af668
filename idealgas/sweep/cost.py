"""Cost estimate of a sweep before it is run."""

import math
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from idealgas.analysis.registry import analyse
from idealgas.analysis.theory.forecast import BYTES_A_ROW, forecast
from idealgas.errors import UserError
from idealgas.initial.build import make_gas
from idealgas.run.simulate import simulate
from idealgas.scene import Scene
from idealgas.sweep.plan import Sweep

TRIAL_EVENTS = 20_000  # events of the short runs that measure the speed
MOST_TRIALS = 32  # short runs of a sweep; combinations between them take the speed of the one before
START = 3.0  # seconds in which workers start
ROWS_PER_SECOND = 1e6  # event rows that an analysis reads per second


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
    """Short run of a scene: rows per event, events per second and per simulated time, seconds of its analyses."""

    rows: float
    per_second: float
    per_time: float
    analysed: float


def estimate_cost(sweep: Sweep, on_progress: Callable[[int, int], None] = lambda done, total: None) -> tuple[Cost, ...]:
    """Cost estimate of each point, from short runs of some of them and, where possible, from theory.

    on_progress: called with the number of combinations of values that have an estimate, and that of all.
    """
    scenes = {point.combination: point.scene for point in sweep.points}
    every = math.ceil(len(scenes) / MOST_TRIALS)
    costs: dict[int, Cost] = {}
    for k, (combination, scene) in enumerate(scenes.items()):
        on_progress(k, len(scenes))
        if k % every == 0:
            trial = _try(scene, sweep.analyses, first=k == 0)
        costs[combination] = _cost(scene, trial, len(sweep.analyses))
    return tuple(costs[point.combination] for point in sweep.points)


def total_seconds(costs: Sequence[Cost], workers: int) -> float:
    """Time of a sweep with the costs of its points on a number of workers of this machine, seconds."""
    seconds = [cost.seconds for cost in costs]
    return START + max(sum(seconds) / workers, max(seconds, default=0.0))


def _cost(scene: Scene, trial: _Trial, analyses: int) -> Cost:
    expected = forecast(scene, make_gas(scene))
    events, size = expected.events, expected.bytes
    if events is None:
        until = scene.run.until or math.inf
        collisions = (scene.run.collisions_per_disc or math.inf) * expected.number / 2  # events, if walls are far
        events = min(scene.run.events or math.inf, collisions, trial.per_time * until)
    if size is None:
        size = events * trial.rows * BYTES_A_ROW[scene.log.compression]
    seconds = trial.analysed + events / trial.per_second + analyses * events * trial.rows / ROWS_PER_SECOND
    return Cost(expected.number, expected.packing_fraction, events, size, seconds)


def _try(scene: Scene, analyses: Sequence[str], first: bool) -> _Trial:
    run = scene.run.model_copy(update={"events": min(TRIAL_EVENTS, scene.run.events or TRIAL_EVENTS)})
    with tempfile.TemporaryDirectory(prefix="idealgas-sweep-") as folder:
        path = Path(folder) / "trial.h5"
        summary = simulate(scene.model_copy(update={"run": run}), path)
        if first:
            _analyse(path, analyses)  # loads machine code
        analysed = _analyse(path, analyses)
    events = max(summary.events, 1)
    return _Trial(summary.rows / events, events / summary.seconds, events / max(summary.end_time, 1e-300), analysed)


def _analyse(path: Path, analyses: Sequence[str]) -> float:
    """Seconds that analyses of a short log take."""
    started = time.monotonic()
    for name in analyses:
        with suppress(UserError):
            analyse(path, name)
    return time.monotonic() - started
