"""Measure errors of the motion: missed collisions, trajectories, and the return to the start after a reversal."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from idealgas.accuracy.cases import Case, EquilibratedStart
from idealgas.columns import Kind, empty_batch
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.multiprecision import PreciseBruteForce, make_columns, turn_back
from idealgas.engine.simulation import NO_STOP, Simulation
from idealgas.run.layout import row_columns
from idealgas.state import Gas
from idealgas.statistics.estimates import Estimate

STARTS = 200  # largest number of starting points for the comparison of collisions
ENOUGH = 5_000  # number of compared collisions that is sufficient
BETWEEN = 2.0  # collisions per disc between two starting points


@dataclass(frozen=True)
class Missed:
    """Number of first collisions after common starts that were compared, and number of those that were missed."""

    compared: int
    missed: int

    @property
    def share(self) -> Estimate:
        """Fraction of missed collisions; if none was missed, the error is that for one missed collision."""
        number = self.compared or math.nan
        return Estimate(self.missed / number, math.sqrt(max(self.missed, 1)) / number, self.compared)


def count_missed(
    start: EquilibratedStart, cases: Sequence[Case], rate: float, progress: Callable[[float], None]
) -> list[Missed]:
    """Count the collisions that each case misses, compared with the event-driven motion over a mean free time.

    Only collisions between two discs that have not yet collided with other discs are compared. A collision is missed
    if, in the case, neither disc has collided by the end of the next time step.

    Args:
        start: the equilibrated gas.
        cases: the cases.
        rate: number of collisions per disc and time.
        progress: function that is called with the fraction of the work that is done.
    """
    reference = start.simulation(EventDriven())
    compared, missed = np.zeros((2, len(cases)), int)
    number = 0
    while number < STARTS and compared.max(initial=0) < ENOUGH:
        gas, effects = reference.state()
        here = EquilibratedStart(gas, effects)
        truth = first_collisions(here, Case("event_driven"), 1 / rate)
        for k, case in enumerate(cases):
            collisions = first_collisions(here, case, 1 / rate + (case.dt or 0.0))
            pairs, through = flown_through(truth, collisions, case.dt or 0.0)
            compared[k] += pairs
            missed[k] += through
        number += 1
        progress(max(number / STARTS, compared.max() / ENOUGH))
        reference.run(pause=number * BETWEEN / rate)
    return [Missed(int(c), int(m)) for c, m in zip(compared, missed, strict=True)]


def first_collisions(start: EquilibratedStart, case: Case, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the times (N,) and partners (N,) of the first collision of each disc; infinity and -1 if it has none."""
    n = len(start.gas)
    time, partner = np.full(n, math.inf), np.full(n, -1)
    simulation = start.simulation(case.make())
    batch = empty_batch(columns=row_columns(start.effects))
    for count in simulation.slices(NO_STOP, batch, pause=duration):
        rows = batch.rows(0, count)
        met = rows.kind == Kind.DISC
        disc, first = np.unique(rows.disc[met], return_index=True)
        new = np.isinf(time[disc])
        time[disc[new]] = rows.time[met][first[new]]
        partner[disc[new]] = rows.partner[met][first[new]]
    return time, partner


def flown_through(
    truth: tuple[np.ndarray, np.ndarray], measured: tuple[np.ndarray, np.ndarray], dt: float
) -> tuple[int, int]:
    """Return the numbers of compared and of missed collisions between discs that both collide first with each other.

    Args:
        truth: times and partners of the first collisions in the event-driven run.
        measured: times and partners of the first collisions in the case.
        dt: time step of the case.
    """
    time, partner = truth
    i = np.flatnonzero(partner >= 0)
    i = i[(partner[partner[i]] == i) & (i < partner[i])]
    j = partner[i]
    by_then = np.minimum(measured[0][i], measured[0][j]) > time[i] + dt
    met = (measured[1][i] == j) & (measured[1][j] == i)
    return int((met | by_then).sum()), int((by_then & ~met).sum())


def positions(simulation: Simulation, times: Sequence[float]) -> np.ndarray:
    """Return the positions (T, N, 2) of the discs at T times, length."""
    frames = []
    for time in times:
        simulation.run(pause=time)
        frames.append(simulation.state()[0].position)
    return np.array(frames)


def rms_distance(a: np.ndarray, b: np.ndarray, gas: Gas) -> np.ndarray:
    """Return the root-mean-square distance between disc positions a and b (..., N, 2), in mean diameters."""
    return np.sqrt(((a - b) ** 2).sum(axis=-1).mean(axis=-1)) / (2 * gas.radius.mean())


def error_on_return(start: EquilibratedStart, case: Case, duration: float) -> float:
    """Return the rms distance from the start after a run, a reversal of all velocities and an equally long run.

    The unit is the mean diameter.
    """
    if case.precision is not None:
        return _error_on_precise_return(start, case.precision, duration)
    simulation = start.simulation(case.make())
    simulation.run(pause=duration)
    gas = simulation.state()[0]
    back = EquilibratedStart(replace(gas, velocity=-gas.velocity), start.effects).simulation(case.make())
    back.run(pause=duration)
    return float(rms_distance(back.state()[0].position, start.gas.position, start.gas))


def _error_on_precise_return(start: EquilibratedStart, precision: str, duration: float) -> float:
    """Return the same as `error_on_return`, computed with all digits of a precision."""
    columns = origin = make_columns(start.gas, precision)
    for _ in range(2):
        method = PreciseBruteForce(precision, columns)
        start.simulation(method).run(pause=duration)
        columns = method.columns
        turn_back(columns, duration)
    apart = [_difference(a, b) for a, b in zip(columns[:2], origin[:2], strict=True)]
    return float(rms_distance(np.column_stack(apart), np.zeros(2), start.gas))


def _difference(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the difference between two columns of nearly equal numbers, as float64."""
    difference = a.astype(float) - b
    return difference if difference.ndim == 1 else difference.sum(axis=1)
