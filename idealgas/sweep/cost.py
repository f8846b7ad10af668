"""Estimate the cost of a sweep before it is run."""

import math
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import NamedTuple

from idealgas.analysis.registry import analyse
from idealgas.errors import UserError
from idealgas.files import beside
from idealgas.initial.build import make_gas
from idealgas.jit import compile_seconds
from idealgas.run.simulate import simulate
from idealgas.scene import Scene
from idealgas.sweep.plan import Sweep
from idealgas.theory.forecast import BYTES_A_ROW, Forecast, forecast

TRIAL_EVENTS = 20_000  # number of events in a short run that measures the speed
MOST_TRIALS = 32  # largest number of short runs; combinations without one are assigned the speed of the last short run
TRIAL_SHARE = 0.02  # largest fraction of the time of the sweep for short runs, if theory predicts the number of events
START = 3.0  # time that workers need to start, execute short runs and stop, s
ROWS_PER_SECOND = 1e6  # number of event rows that an analysis reads per second
_imported: set[tuple[str, ...]] = set()  # analyses whose modules this process has imported in a short run


class Cost(NamedTuple):
    """Estimated cost of a point in a sweep.

    Attributes:
        number: number of discs.
        packing_fraction: packing fraction, no unit.
        events: number of events.
        bytes: size of the log, bytes.
        seconds: time taken by the run and its analyses, s.
    """

    number: int
    packing_fraction: float
    events: float
    bytes: float
    seconds: float


class Trial(NamedTuple):
    """Results of a short run of a scene.

    Attributes:
        rows: number of event rows per event.
        per_second: number of events per second.
        per_time: number of events per unit of simulated time.
        seconds: time taken by the run and its analyses, s.
        apart: part of this time in which no events are simulated, s.
    """

    rows: float
    per_second: float
    per_time: float
    seconds: float
    apart: float


def estimate_cost(
    sweep: Sweep,
    on_progress: Callable[[int, int], None] = lambda done, total: None,
    *,
    folder: Path | None = None,
    execute: Callable[[Callable[[Scene], Trial], Sequence[Scene]], Iterable[Trial]] = map,
) -> tuple[Cost, ...]:
    """Return the estimated cost of each point, from short runs of some points and, where possible, from theory.

    Args:
        sweep: the sweep.
        on_progress: function that is called with the number of finished steps (first forecasts, then short runs) and
            the total number of steps.
        folder: folder for the logs of the short runs, which are removed afterwards; None for a temporary folder.
        execute: function like `map` that executes the short runs; `map` itself executes them in this process.
    """
    combinations = {point.combination: point.scene for point in sweep.points}
    scenes, forecasts = list(combinations.values()), list[Forecast]()
    for k, scene in enumerate(scenes):
        on_progress(k, len(scenes))
        forecasts.append(forecast(scene, make_gas(scene)))

    def costs(trials: Sequence[Trial], every: int) -> tuple[Cost, ...]:
        each = [_cost(scene, forecasts[k], trials[k // every], len(sweep.analyses)) for k, scene in enumerate(scenes)]
        by_combination = dict(zip(combinations, each, strict=True))
        return tuple(by_combination[point.combination] for point in sweep.points)

    with tempfile.TemporaryDirectory(prefix="idealgas-sweep-") as temporary:
        run = partial(_try, analyses=sweep.analyses, folder=folder or Path(temporary))
        trials, number = list(execute(run, scenes[:1])), MOST_TRIALS
        if all(expected.events is not None and expected.bytes is not None for expected in forecasts):
            seconds = sum(cost.seconds for cost in costs(trials, len(scenes)))
            number = min(number, max(1, int(TRIAL_SHARE * seconds / trials[0].seconds)))
        every = math.ceil(len(scenes) / number)
        chosen = scenes[every::every]
        for k, trial in enumerate(execute(run, chosen)):
            on_progress(k, len(chosen))
            trials.append(trial)
    return costs(trials, every)


def total_seconds(costs: Sequence[Cost], workers: int) -> float:
    """Return the time that a sweep with these costs takes on a number of workers on this machine, s."""
    seconds = [cost.seconds for cost in costs]
    return START + max(sum(seconds) / workers, max(seconds, default=0.0))


def _cost(scene: Scene, expected: Forecast, trial: Trial, analyses: int) -> Cost:
    events, size = expected.events, expected.bytes
    if events is None:
        until = scene.run.until or math.inf
        # wall hits are neglected
        collisions = (scene.run.collisions_per_disc or math.inf) * expected.number / 2
        events = min(scene.run.events or math.inf, collisions, trial.per_time * until)
    if size is None:
        size = events * trial.rows * BYTES_A_ROW[scene.log.compression]
    seconds = trial.apart + events / trial.per_second + analyses * events * trial.rows / ROWS_PER_SECOND
    return Cost(expected.number, expected.packing_fraction, events, size, seconds)


def _try(scene: Scene, analyses: tuple[str, ...], folder: Path) -> Trial:
    """Run a scene for a short time; the first run in a process is repeated, because it also imports modules."""
    if analyses not in _imported:
        _imported.add(analyses)
        _try(scene, analyses, folder)
    run = scene.run.model_copy(update={"events": min(TRIAL_EVENTS, scene.run.events or TRIAL_EVENTS)})
    path, started = beside(folder / "trial.h5"), _clock()
    try:
        summary = simulate(scene.model_copy(update={"run": run}), path)
        for name in analyses:
            with suppress(UserError):
                analyse(path, name)
    finally:
        path.unlink(missing_ok=True)
    seconds, events = _clock() - started, max(summary.events, 1)
    per_second, per_time = events / summary.seconds, events / max(summary.end_time, 1e-300)
    return Trial(summary.rows / events, per_second, per_time, seconds, max(seconds - summary.seconds, 0.0))


def _clock() -> float:
    """Return the time excluding the time spent on compilation, s."""
    return time.monotonic() - compile_seconds()
