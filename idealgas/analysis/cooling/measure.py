"""How a gas cools whose discs lose energy in their collisions, measured at many times and compared with theory."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from idealgas.analysis.cooling.theory import (
    CUMULANT_ERROR,
    LOSS_ERROR,
    RATIO_ERROR,
    TIME_ERROR,
    collision_rate,
    expected_series,
    granular_parameters,
)
from idealgas.analysis.core.caveats import narrow
from idealgas.analysis.core.ensemble import centre_of_mass_velocity, degrees_of_freedom
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, estimate, mean, mean_of_part, ratio
from idealgas.analysis.core.stream import span
from idealgas.analysis.theory import granular
from idealgas.analysis.theory.granular import GranularParameters
from idealgas.analysis.theory.values import Theory
from idealgas.errors import NotApplicableError
from idealgas.log import Log, LogState

INSTANTS = 257
FEW = 10
"""Number of discs below which the laws are said to be those of many."""

FEWEST = 16
"""Least number of instants in the window of the averages."""

SETTLED, FOLDS = 20.0, 5.0
"""Averages begin after so many collisions per disc, and after so many of the times in which the temperature ratio comes
nearer to its value by a factor e."""

IN_A_CELL = 8
"""Mean number of discs in the cells in which they are counted, about."""

MANY = 4.0
"""Standard errors of single states by which a gas is told from a uniform one."""


@dataclass(frozen=True)
class Cooling(Result):
    """Cooling of a gas at F times, and what the laws of a uniform gas say of it.

    time: (F,), times. collisions: (F,), mean number of collisions of a disc before them. temperature: (F,), mean
    m v²/2 in the frame of the centre of mass, energy. spin: (F,), mean I ω², energy; None without spin. cumulant: (F,),
    a₂ of the velocities. scatter: (F,), variance of the numbers of discs in `cells` equal cells over their mean; 1 for
    discs without size at random places. flow: (F,), mean square of the momentum in a cell over that of
    discs that move independently. law, spin_law: (F,), temperatures of motion and spin by theory; None without.

    start, end: window of the averages, time. loss: part of the temperature lost per collision of a disc. haff: Haff's
    time τ of T = T₀/(1 + t/τ)² with the temperature T₀ at time 0. fourth: mean of a₂. temperature_ratio: mean of spin
    over temperature; None without rough discs. first_scatter, last_scatter: mean of scatter in the first and in the
    last tenth of the collisions. last_flow: mean of flow in the last tenth.
    """

    time: np.ndarray
    collisions: np.ndarray
    temperature: np.ndarray
    spin: np.ndarray | None
    cumulant: np.ndarray
    scatter: np.ndarray
    flow: np.ndarray
    cells: int
    law: np.ndarray | None
    spin_law: np.ndarray | None
    start: float
    end: float
    loss: Estimate
    haff: Estimate
    fourth: Estimate
    temperature_ratio: Estimate | None
    first_scatter: Estimate
    last_scatter: Estimate
    last_flow: Estimate


def cooling(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Cooling:
    """Measure how a gas of equal discs cools by its collisions, and compare it with the laws of a uniform gas.

    start, end: window of the averages, times; by default from 20 collisions per disc (more where the ratio of the
    temperatures takes longer) to the end of the log. progress(
    done, in all) is called as states are read. Raises NotApplicableError where anything but collisions of equal discs
    changes the energy, or where the window is too short.
    """
    parameters, dof = granular_parameters(log), degrees_of_freedom(log)
    first, last = span(log, None, end)
    t0 = _temperature(log, log.state_at(log.start_time), dof)
    s0 = _spin(log, log.state_at(log.start_time))
    rate = collision_rate(log, t0)
    time = _instants(granular.cooling_time(parameters, rate) if rate else last - first, first, last)
    temperature, spin, cumulant, scatter, flow = np.empty((5, len(time)))
    counted = _Cells(log)
    for k, state in enumerate(log.frames(time)):
        temperature[k], spin[k] = _temperature(log, state, dof), _spin(log, state)
        cumulant[k] = _cumulant(log, state, dof)
        scatter[k], flow[k] = counted.count(state.position, state.velocity - centre_of_mass_velocity(log))
        if progress is not None:
            progress(k + 1, len(time))
    collisions = _collisions(log, time)
    settled = max(SETTLED, FOLDS * granular.relaxation(parameters))
    window = np.flatnonzero(collisions >= settled if start is None else time >= start)
    if len(window) < FEWEST:
        needs = f"the averages begin after {settled:.3g}; --from T sets a start by hand"
        raise NotApplicableError(f"{log.path}: too short, with {collisions[-1]:.3g} collisions per disc ({needs})")
    share = dof / (2 * len(log.discs))  # a conserved momentum leaves as much heat to fewer degrees of freedom
    fast = None if rate is None else rate / share
    law = expected_series(parameters, fast, t0, s0, time)
    tenths = collisions / collisions[-1]
    early, late = (mean_of_part(scatter, part) for part in (tenths <= 0.1, tenths >= 0.9))
    together = mean_of_part(flow, tenths >= 0.9)
    everything = time, collisions, temperature, spin, cumulant
    return Cooling(
        time,
        collisions,
        temperature,
        spin if log.inertia is not None else None,
        cumulant,
        scatter,
        flow,
        counted.number,
        None if law is None else law[0],
        None if law is None or log.inertia is None else law[1],
        float(time[window[0]]),
        float(time[-1]),
        *_averages(parameters, fast, t0, TimeSeries(*(each[window] for each in everything)), dof, len(log.discs)),
        early,
        late,
        together,
        caveats=(
            *_untested(log, parameters),
            *narrow(log),
            *_caveats(early.value, late.value, together.value, counted.number),
        ),
    )


class TimeSeries(NamedTuple):
    """Series at the times of a window: as the fields of `Cooling` of these names."""

    time: np.ndarray
    collisions: np.ndarray
    temperature: np.ndarray
    spin: np.ndarray
    cumulant: np.ndarray


def _averages(
    parameters: GranularParameters, rate: float | None, t0: float, series: TimeSeries, dof: int, n: int
) -> tuple[Estimate, Estimate, Estimate, Estimate | None]:
    """Loss per collision, Haff's time, a₂ and the temperature ratio.

    rate: collision rate of a disc of a gas that keeps no momentum, 1/time. t0: temperature at time 0. dof: degrees of
    freedom of the motion of the n discs.
    """
    energy, few = series.temperature + n / dof * series.spin, 1 / dof
    temperature = energy * (series.temperature / energy).mean()  # without the exchange between motion and spin
    lost, apart = -np.diff(np.log(temperature)), np.diff(series.collisions)
    expected = granular.cooling_per_collision(parameters) * 2 * n / dof
    loss = ratio(lost, apart, _theory(parameters, expected, math.hypot(LOSS_ERROR, few)))
    slopes = np.diff(temperature**-0.5) / np.diff(series.time)  # the same at all times
    tau = None if rate is None else granular.cooling_time(parameters, rate)
    law = _theory(parameters, tau, math.hypot(TIME_ERROR, few))
    haff = estimate(lambda slope: 1 / (slope * math.sqrt(t0)), slopes, theory=law)
    if not parameters.rough:
        a2 = _theory(parameters, granular.fourth_cumulant(parameters.normal), CUMULANT_ERROR)
        return loss, haff, mean(series.cumulant, a2), None
    share = mean(
        series.spin / series.temperature, _theory(parameters, granular.temperature_ratio(parameters), RATIO_ERROR)
    )
    return loss, haff, mean(series.cumulant), share


def _theory(parameters: GranularParameters, value: float | None, relative: float) -> Theory | None:
    if value is None or parameters.normal < granular.TESTED_FROM:
        return None
    return Theory(value, relative * abs(value), "homogeneous cooling")


def _untested(log: Log, parameters: GranularParameters) -> Iterator[str]:
    """Sentences on a gas of few discs, and on losses beyond the range of the laws."""
    if (number := len(log.discs)) < FEW:
        yield f"The laws are those of many discs, and here are {number}."
    if parameters.normal < granular.TESTED_FROM:
        yield f"There is no theory of collisions that lose more than those with e = {granular.TESTED_FROM:g}."


def _caveats(early: float, late: float, flow: float, cells: int) -> Iterator[str]:
    """What tells that the gas is not uniform at the end, beyond what chance allows in single states of M cells.

    There scatter has an error of √(2/(M - 1)) of itself, and flow one of 1/√M.
    """
    uniform = "and the laws are those of a uniform gas."
    if late > early * (1 + MANY * math.sqrt(4 / (cells - 1))):
        words = f"numbers of discs in small cells scatter {late / early:.3g} times as much as at the start"
        yield f"Clusters form: {words}, {uniform}"
    if flow > 1 + MANY / math.sqrt(cells):
        words = f"momenta of small cells have {flow:.3g} times the square of independent discs"
        yield f"Discs move together: {words}, {uniform}"


def _instants(tau: float, first: float, last: float) -> np.ndarray:
    """Times (F,) between which a gas that follows Haff's law with the time τ has equally many collisions."""
    return np.clip(np.geomspace(tau + first, tau + last, INSTANTS) - tau, first, last)


def _collisions(log: Log, time: np.ndarray) -> np.ndarray:
    """Collisions of a disc with other discs, on the average, from time[0] to each of the times (F,)."""
    counts = np.zeros(len(time))
    for rows in log.chunks(("time", "partner"), log.row_at(time[0], "right"), log.row_at(time[-1], "right")):
        counts += rows.time[rows.partner >= 0].searchsorted(time, "right")
    return counts / len(log.discs)


def _temperature(log: Log, state: LogState, dof: int) -> float:
    return float((log.discs.mass * ((state.velocity - centre_of_mass_velocity(log)) ** 2).sum(axis=1)).sum() / dof)


def _spin(log: Log, state: LogState) -> float:
    if log.inertia is None or state.angular_velocity is None:
        return 0.0
    return float((log.inertia * state.angular_velocity**2).mean())


def _cumulant(log: Log, state: LogState, dof: int) -> float:
    """a₂ at one instant, without the bias of few discs: at fixed energy Gaussian ones have -2/(D + 2) on average."""
    square = ((state.velocity - centre_of_mass_velocity(log)) ** 2).sum(axis=1)
    return float((dof + 2) / dof * (square**2).mean() / (2 * square.mean() ** 2) - 1)


class _Cells:
    """Equal cells of the box in which discs are counted. number: of them."""

    def __init__(self, log: Log) -> None:
        width, height = log.box
        side = math.sqrt(IN_A_CELL * width * height / len(log.discs))
        self._box = np.array(log.box)
        self._shape = np.maximum(np.round(self._box / side).astype(int), 1)
        if (self._shape < 2).all():
            self._shape[:] = 2
        self.number = int(self._shape.prod())

    def count(self, position: np.ndarray, velocity: np.ndarray) -> tuple[float, float]:
        """Variance of the numbers of discs over their mean; square of the sums of velocities over that by chance."""
        at = np.minimum((position / self._box * self._shape).astype(int), self._shape - 1)
        cell = at[:, 0] * self._shape[1] + at[:, 1]
        counts = np.bincount(cell, minlength=self.number)
        sums = sum(np.bincount(cell, v, self.number) ** 2 for v in velocity.T)
        return float(counts.var(ddof=1) / counts.mean()), float(np.sum(sums) / (velocity**2).sum())
