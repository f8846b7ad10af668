"""Measure the errors and the CPU time of each case in the comparison, in one process."""

import math
import statistics
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from idealgas.accuracy.averages import Averages, measure_averages
from idealgas.accuracy.bias import BiasLaw, rate_biases
from idealgas.accuracy.cases import Case, EquilibratedStart, compared_cases, cpu_seconds, equilibrated
from idealgas.accuracy.motion import Missed, count_missed, error_on_return, positions, rms_distance
from idealgas.errors import UserError
from idealgas.initial.build import make_gas
from idealgas.log.summary import Summary
from idealgas.scene import Scene
from idealgas.state import Gas
from idealgas.statistics.estimates import Estimate, mean

SHORTEST_TIMING = 0.1  # shortest timed run, CPU seconds
RATE_SECONDS = 30.0  # total duration of the runs for the collision rates, CPU seconds
RATE_BLOCKS = 64  # number of blocks of each of these runs
BURN_IN = 0.1  # initial fraction of these runs that is discarded while the gas adapts to the method
LONGEST_RUN = 40.0  # longest run of a case for its averages, and for the reference trajectories, CPU seconds
MOST_PRECISE = 4000  # largest number of discs for brute force
FOLLOWED = (0.25, 0.5, 0.75, 1, 1.5, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 8, 9, 10, 12, 14, 16)
"""Collisions per disc at which trajectories are compared; at the last of these, no digit of a float64 is correct."""

Progress = Callable[[str, float], None]
"""Function that is called with the name of the current task and the fraction of it that is done."""


@dataclass(frozen=True)
class Timing:
    """CPU time of a case.

    Attributes:
        median: median, over the repeats, of the CPU seconds per unit of simulated time.
        least: smallest of these values.
        most: largest of these values.
        collisions: number of pair collisions per unit of simulated time.
    """

    median: float
    least: float
    most: float
    collisions: float

    @property
    def per_collision(self) -> float:
        """CPU seconds per pair collision."""
        return self.median / self.collisions if self.collisions else math.nan


@dataclass(frozen=True)
class AccuracyRow:
    """CPU time and errors of a case; errors that were not measured are None.

    Attributes:
        case: method, time step and precision.
        timing: CPU time.
        averages: averages over the whole run.
        rate: bias of the collision rate: for time steps relative to the common limit dt → 0, for precisions relative to
            the event-driven run.
        z_pairs: bias of the pressure from the virial of the pairs, relative to theory.
        z_walls: bias of the pressure from the virial of the walls, relative to theory.
        missed: missed collisions.
        trajectory: (T,), rms distance from the reference trajectories, diameters.
        way_back: rms distance from the start after a run, a reversal of all velocities and an equally long run,
            diameters.
    """

    case: Case
    timing: Timing
    averages: Averages | None
    rate: Estimate | None
    z_pairs: Estimate | None
    z_walls: Estimate | None
    missed: Missed | None
    trajectory: np.ndarray | None
    way_back: float | None


@dataclass(frozen=True)
class Accuracy:
    """CPU time and errors of all cases for a scene.

    Attributes:
        title: title of the scene.
        number: number of discs.
        until: simulated time of the runs for averages.
        repeats: number of timings of each case.
        collisions: (T,), collisions per disc at which trajectories were compared; empty if they were not compared.
        left_out: reason why brute force in several precisions was not run; empty if it was.
        rate_law: bias of the collision rate caused by time steps; None if it is not significant.
        rows: one row for each case.
    """

    title: str
    number: int
    until: float
    repeats: int
    collisions: np.ndarray
    left_out: str
    rate_law: BiasLaw | None
    rows: tuple[AccuracyRow, ...]

    @property
    def event_driven(self) -> AccuracyRow:
        """Row of the event-driven run."""
        return self.rows[0]

    @property
    def steps(self) -> list[AccuracyRow]:
        """Rows of the time steps, from long to short."""
        return [row for row in self.rows if row.case.dt is not None]

    @property
    def precisions(self) -> list[AccuracyRow]:
        """Rows of brute force, from few digits to many."""
        return [row for row in self.rows if row.case.precision is not None]


def study_accuracy(scene: Scene, repeats: int = 3, progress: Progress = lambda what, share: None) -> Accuracy:
    """Run a scene in all cases, and measure CPU time and errors.

    Args:
        scene: the scene.
        repeats: number of timings of each case.
        progress: function that is called with the name of the current task and the fraction of it that is done.

    Raises:
        UserError: if the scene cannot be run with time steps, or if its discs cannot collide with each other.
    """
    check(scene)
    progress("equilibrating the gas", 0.0)
    start = equilibrated(scene)
    left_out = why_not_precise(scene, start.gas)
    cases = compared_cases(start.gas, precise=not left_out)
    timings = measure_timings(start, cases, repeats, progress)
    averages, until = _all_averages(scene, cases, timings, progress)
    truth = averages[0]
    assert truth is not None
    rate = 2 * truth.rate.value / len(start.gas)
    steps = [case for case in cases if case.dt is not None]
    counts = count_missed(start, steps, rate, lambda share: progress("missed collisions", share))
    missed = dict(zip(steps, counts, strict=True))
    biases, rate_law = rate_biases(
        np.array([0.0, *(case.dt for case in steps if case.dt)]),
        measure_rates(start, cases[: len(steps) + 1], timings, progress),
    )
    rates = dict(zip(steps, biases[1:], strict=False))
    collisions, trajectories, ways_back = _motion(start, cases, timings, rate, progress)
    rows = [
        AccuracyRow(
            case, timing, measured,
            rate=relative(measured.rate, truth.rate) if case.precision and measured else rates.get(case),
            z_pairs=None if measured is None else from_theory(measured.z_pairs),
            z_walls=None if measured is None else from_theory(measured.z_walls),
            missed=missed.get(case),
            trajectory=trajectories.get(case),
            way_back=ways_back.get(case),
        )
        for case, timing, measured in zip(cases, timings, averages, strict=True)
    ]  # fmt: skip
    return Accuracy(scene.scene.title, len(start.gas), until, repeats, collisions, left_out, rate_law, tuple(rows))


def check(scene: Scene) -> None:
    """Check that a scene can be run with time steps and has at least two discs.

    Raises:
        UserError: if it cannot be run with time steps or has a single disc.
    """
    if scene.run.method == "monte_carlo":
        raise UserError("run.method: nothing to compare (got monte_carlo; allowed a method that moves discs)")
    if unsupported := scene.lacking("allows_time_steps"):
        raise UserError(f"nothing to compare: time steps do not support {' and '.join(unsupported)}")
    if len(make_gas(scene)) < 2:
        raise UserError("nothing to compare: a single disc never collides with another")


def why_not_precise(scene: Scene, gas: Gas) -> str:
    """Return the reason why a gas cannot be run in all precisions; empty if it can."""
    if scene.effects:
        return f"only float64 supports {', '.join(scene.effects)}"
    if len(gas) > MOST_PRECISE:
        return f"brute force takes too long with more than {MOST_PRECISE} discs"
    return ""


def relative(value: Estimate, reference: Estimate) -> Estimate:
    """Return the relative difference value/reference - 1 between two independent estimates."""
    ratio = value.value / reference.value
    error = ratio * math.hypot(value.standard_error / value.value, reference.standard_error / reference.value)
    return Estimate(ratio - 1, error, math.inf)


def from_theory(value: Estimate | None) -> Estimate | None:
    """Return the relative deviation value/theory - 1 of an estimate, with both errors; None without theory."""
    if value is None or value.theory is None or not math.isfinite(value.theory):
        return None
    error = math.hypot(value.standard_error, value.theory_error) / value.theory
    return Estimate(value.value / value.theory - 1, error, math.inf)


def measure_timings(start: EquilibratedStart, cases: Sequence[Case], repeats: int, progress: Progress) -> list[Timing]:
    """Return the CPU time of each case; the cases are measured in turn, in runs of at least SHORTEST_TIMING."""
    durations = []
    for k, case in enumerate(cases):
        progress("compiling and first timing", k / len(cases))
        durations.append(_long_enough(start, case))
    seconds: list[list[float]] = [[] for _ in cases]
    rates = []
    for repeat in range(repeats):
        for k, (case, duration) in enumerate(zip(cases, durations, strict=True)):
            progress("timing", (repeat + k / len(cases)) / repeats)
            simulation = start.simulation(case.make())
            seconds[k].append(cpu_seconds(simulation, duration) / duration)
            if repeat == 0:
                rates.append(simulation.counters.disc_collisions / duration)
    return [
        Timing(statistics.median(each), min(each), max(each), rate) for each, rate in zip(seconds, rates, strict=True)
    ]


def _long_enough(start: EquilibratedStart, case: Case) -> float:
    """Return the simulated time of a run that takes SHORTEST_TIMING; this also compiles the machine code."""
    speed = float(np.hypot(*start.gas.velocity.T).mean())
    duration = 2.0 ** math.floor(math.log2(start.gas.radius.min() / speed))
    cpu_seconds(start.simulation(case.make()), duration)
    simulation = start.simulation(case.make())
    while cpu_seconds(simulation, duration) < SHORTEST_TIMING:
        duration *= 2
        simulation = start.simulation(case.make())
    return duration


def measure_rates(
    start: EquilibratedStart, cases: Sequence[Case], timings: Sequence[Timing], progress: Progress
) -> list[Estimate]:
    """Return the pair collisions per time in each case, from runs of equal length that take RATE_SECONDS in total."""
    whole = RATE_SECONDS / sum(timing.median for timing in timings[: len(cases)])
    edges = np.linspace(BURN_IN * whole, whole, RATE_BLOCKS + 1)
    rates = []
    for k, case in enumerate(cases):
        progress("collision rates", k / len(cases))
        simulation, counts = start.simulation(case.make()), []
        for time in edges.tolist():
            simulation.run(pause=time)
            counts.append(simulation.counters.disc_collisions)
        rates.append(mean(np.diff(counts) / np.diff(edges)))
    return rates


def _all_averages(
    scene: Scene, cases: Sequence[Case], timings: Sequence[Timing], progress: Progress
) -> tuple[list[Averages | None], float]:
    """Return the averages of the scene in all cases that are fast enough, and the simulated time of the runs.

    The event-driven run, which comes first, determines this time.
    """
    averages: list[Averages | None] = []
    with tempfile.TemporaryDirectory(prefix="idealgas-accuracy-") as folder:
        path = Path(folder) / "run.h5"

        def run(scene: Scene, case: Case, window: float | None = None) -> tuple[Averages, Summary]:
            return measure_averages(scene, path, window, lambda share: progress(f"averages, {case.name}", share))

        settings = scene.run.model_copy(update={"method": "event_driven", "dt": None, "precision": None})
        first, summary = run(scene.model_copy(update={"run": settings}), cases[0])
        averages.append(first)
        for case, timing in zip(cases[1:], timings[1:], strict=True):
            is_fast = timing.median * summary.end_time < LONGEST_RUN
            is_new = case.precision != "float64"  # float64 has the same motion as the event-driven run
            can_run = is_fast and is_new
            averages.append(run(case.scene(scene, summary.end_time), case, first.window)[0] if can_run else None)
    return averages, summary.end_time


def _motion(
    start: EquilibratedStart, cases: Sequence[Case], timings: Sequence[Timing], rate: float, progress: Progress
) -> tuple[np.ndarray, dict[Case, np.ndarray], dict[Case, float]]:
    """Return the collisions per disc, and `trajectory` and `way_back` of each case for `AccuracyRow`.

    The reference is the double-double motion.
    """
    if cases[-1].precision is None:
        return np.empty(0), {}, {}
    reference, timing = cases[-1], timings[-1]
    longest = LONGEST_RUN / 2 / timing.median * rate
    collisions = np.array([count for count in FOLLOWED if count <= max(longest, FOLLOWED[0])])
    times = (collisions / rate).tolist()
    progress("reference trajectory, double-double", 0.0)
    truth = positions(start.simulation(reference.make()), times)
    trajectories, ways_back = {}, {}
    for k, case in enumerate(cases):
        progress("trajectories and reversals", k / len(cases))
        if case is not reference:
            trajectories[case] = rms_distance(positions(start.simulation(case.make()), times), truth, start.gas)
        ways_back[case] = error_on_return(start, case, min(times[-1], 1 / rate))
    return collisions, trajectories, ways_back
