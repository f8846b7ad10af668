"""How far the motion itself is wrong on a rung: missed collisions, trajectories, and the way back."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.precise import PreciseBruteForce, make_columns, turn_back
from idealgas.engine.simulation import NO_STOP, Simulation
from idealgas.events import EventBatch, Kind, empty_batch
from idealgas.gas.state import Gas
from idealgas.physics.effects import Effects
from idealgas.run.layout import row_columns
from idealgas.study.accuracy.cases import Case, Start

STARTS = 200  # at most, from which collisions are compared
ENOUGH = 5_000  # collisions compared
BETWEEN = 2.0  # collisions a disc between two starts


@dataclass(frozen=True)
class Missed:
    """Of first collisions after a common start: how many there were, and how many discs flew straight through."""

    compared: int
    missed: int

    @property
    def share(self) -> float:
        return self.missed / self.compared if self.compared else math.nan

    @property
    def error(self) -> float:
        """Standard error of the share; of one, where none was missed."""
        return math.sqrt(max(self.missed, 1)) / self.compared if self.compared else math.nan


def count_missed(start: Start, cases: Sequence[Case], rate: float, progress: Callable[[float], None]) -> list[Missed]:
    """Compare each rung with the event-driven motion, over a mean free time from many starts.

    rate: collisions per disc and time. Compared are the collisions of two discs that have met no other disc yet: both
    fly straight, or from wall to wall, in both runs. Missed is one if on the rung neither disc has met anybody by the
    end of the step after.
    """
    reference = start.simulation(EventDriven())
    compared, missed = np.zeros((2, len(cases)), int)
    number = 0
    while number < STARTS and compared.max(initial=0) < ENOUGH:
        gas, effects = reference.state()
        here = Start(gas, effects)
        found = first_collisions(here, Case("event_driven"), 1 / rate)
        for k, case in enumerate(cases):
            own = first_collisions(here, case, 1 / rate + (case.dt or 0.0))
            pairs, through = flown_through(found, own, case.dt or 0.0)
            compared[k] += pairs
            missed[k] += through
        number += 1
        progress(max(number / STARTS, compared.max() / ENOUGH))
        reference.run(pause=number * BETWEEN / rate)
    return [Missed(int(c), int(m)) for c, m in zip(compared, missed, strict=True)]


def first_collisions(start: Start, case: Case, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """When each disc first meets another, infinite if it does not, and whom."""
    n = len(start.gas)
    time, partner = np.full(n, math.inf), np.full(n, -1)
    simulation = start.simulation(case.make())
    batch = batch_for(start.effects)
    for count in simulation.slices(NO_STOP, batch, pause=duration):
        rows = batch.rows(0, count)
        met = rows.kind == Kind.DISC
        disc, first = np.unique(rows.disc[met], return_index=True)
        new = np.isinf(time[disc])
        time[disc[new]] = rows.time[met][first[new]]
        partner[disc[new]] = rows.partner[met][first[new]]
    return time, partner


def batch_for(effects: Effects) -> EventBatch:
    """A batch with the columns that the effects call for."""
    return empty_batch(columns=row_columns(effects))


def flown_through(
    truth: tuple[np.ndarray, np.ndarray], found: tuple[np.ndarray, np.ndarray], dt: float
) -> tuple[int, int]:
    """Of the pairs whose first collision is with each other: how many are found or flown through; the latter."""
    time, partner = truth
    i = np.flatnonzero(partner >= 0)
    i = i[(partner[partner[i]] == i) & (i < partner[i])]
    j = partner[i]
    by_then = np.minimum(found[0][i], found[0][j]) > time[i] + dt
    met = (found[1][i] == j) & (found[1][j] == i)
    return int((met | by_then).sum()), int((by_then & ~met).sum())


def positions(simulation: Simulation, times: Sequence[float]) -> np.ndarray:
    """(T, N, 2): where the discs are."""
    found = []
    for time in times:
        simulation.run(pause=time)
        found.append(simulation.state()[0].position)
    return np.array(found)


def rms_distance(a: np.ndarray, b: np.ndarray, gas: Gas) -> np.ndarray:
    """Root mean square over the discs, in mean diameters; last axes (N, 2)."""
    return np.sqrt(((a - b) ** 2).sum(axis=-1).mean(axis=-1)) / (2 * gas.radius.mean())


def error_on_return(start: Start, case: Case, duration: float) -> float:
    """Run, reverse all velocities, run as long again: rms distance from the start, in mean diameters."""
    if case.precision is not None:
        return _error_on_precise_return(start, case.precision, duration)
    simulation = start.simulation(case.make())
    simulation.run(pause=duration)
    gas = simulation.state()[0]
    back = Start(replace(gas, velocity=-gas.velocity), start.effects).simulation(case.make())
    back.run(pause=duration)
    return float(rms_distance(back.state()[0].position, start.gas.position, start.gas))


def _error_on_precise_return(start: Start, precision: str, duration: float) -> float:
    """The same with all the digits of the precision."""
    columns = origin = make_columns(start.gas, precision)
    for _ in range(2):
        method = PreciseBruteForce(precision, columns)
        start.simulation(method).run(pause=duration)
        columns = method.columns
        turn_back(columns, duration)
    apart = [_difference(a, b) for a, b in zip(columns[:2], origin[:2], strict=True)]
    return float(rms_distance(np.column_stack(apart), np.zeros(2), start.gas))


def _difference(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of two columns of nearly the same numbers."""
    rest = a.astype(float) - b
    return rest if rest.ndim == 1 else rest.sum(axis=1)
