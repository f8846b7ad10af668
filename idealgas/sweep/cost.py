"""Cost estimate of a sweep before it is run."""

import math
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from idealgas.analysis.registry import analyse
from idealgas.analysis.theory.forecast import BYTES_A_ROW, Forecast, forecast
from idealgas.errors import UserError
from idealgas.initial.build import make_gas
from idealgas.jit import compile_seconds
from idealgas.run.simulate import simulate
from idealgas.scene import Scene
from idealgas.sweep.plan import Sweep

TRIAL_EVENTS = 20_000  # events of the short runs that measure the speed
MOST_TRIALS = 32  # short runs of a sweep; combinations between them take the speed of the one before
TRIAL_SHARE = 0.02  # of the time that they estimate, which short runs take where theory forecasts the events
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
    """Short run of a scene.

    rows: per event. per_second, per_time: events per second and per simulated time. seconds: time it took with its
    analyses. apart: the part of this time in which no events are simulated.
    """

    rows: float
    per_second: float
    per_time: float
    seconds: float
    apart: float


def estimate_cost(sweep: Sweep, on_progress: Callable[[int, int], None] = lambda done, total: None) -> tuple[Cost, ...]:
    """Cost estimate of each point, from short runs of some of them and, where possible, from theory.

    on_progress: called with the number of steps that are done, and that of all: two for each combination of values.
    """
    scenes = {point.combination: point.scene for point in sweep.points}
    forecasts: dict[int, Forecast] = {}
    for combination, scene in scenes.items():
        on_progress(len(forecasts), 2 * len(scenes))
        forecasts[combination] = forecast(scene, make_gas(scene))

    def cost(combination: int, trial: _Trial) -> Cost:
        return _cost(scenes[combination], forecasts[combination], trial, len(sweep.analyses))

    _try(sweep.points[0].scene, sweep.analyses)  # imports modules
    trial, trials = _try(sweep.points[0].scene, sweep.analyses), MOST_TRIALS
    if all(known.events is not None and known.bytes is not None for known in forecasts.values()):
        seconds = sum(cost(point.combination, trial).seconds for point in sweep.points)
        trials = min(trials, max(1, int(TRIAL_SHARE * seconds / trial.seconds)))
    every = math.ceil(len(scenes) / trials)
    costs: dict[int, Cost] = {}
    for k, (combination, scene) in enumerate(scenes.items()):
        on_progress(len(scenes) + k, 2 * len(scenes))
        if k and k % every == 0:
            trial = _try(scene, sweep.analyses)
        costs[combination] = cost(combination, trial)
    return tuple(costs[point.combination] for point in sweep.points)


def total_seconds(costs: Sequence[Cost], workers: int) -> float:
    """Time of a sweep with the costs of its points on a number of workers of this machine, seconds."""
    seconds = [cost.seconds for cost in costs]
    return START + max(sum(seconds) / workers, max(seconds, default=0.0))


def _cost(scene: Scene, expected: Forecast, trial: _Trial, analyses: int) -> Cost:
    events, size = expected.events, expected.bytes
    if events is None:
        until = scene.run.until or math.inf
        collisions = (scene.run.collisions_per_disc or math.inf) * expected.number / 2  # events, if walls are far
        events = min(scene.run.events or math.inf, collisions, trial.per_time * until)
    if size is None:
        size = events * trial.rows * BYTES_A_ROW[scene.log.compression]
    seconds = trial.apart + events / trial.per_second + analyses * events * trial.rows / ROWS_PER_SECOND
    return Cost(expected.number, expected.packing_fraction, events, size, seconds)


def _try(scene: Scene, analyses: Sequence[str]) -> _Trial:
    run = scene.run.model_copy(update={"events": min(TRIAL_EVENTS, scene.run.events or TRIAL_EVENTS)})
    started = _clock()
    with tempfile.TemporaryDirectory(prefix="idealgas-sweep-") as folder:
        path = Path(folder) / "trial.h5"
        summary = simulate(scene.model_copy(update={"run": run}), path)
        for name in analyses:
            with suppress(UserError):
                analyse(path, name)
    seconds, events = _clock() - started, max(summary.events, 1)
    per_second, per_time = events / summary.seconds, events / max(summary.end_time, 1e-300)
    return _Trial(summary.rows / events, per_second, per_time, seconds, max(seconds - summary.seconds, 0.0))


def _clock() -> float:
    """Time without that of compilation, seconds."""
    return time.monotonic() - compile_seconds()
