"""Status of a run that may still be in progress: the latest state in its log, and the pressure from recent events."""

from dataclasses import dataclass

import numpy as np

from idealgas.analysis.caveats import log_caveats
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.pressure.routes import PAIRS
from idealgas.errors import UserError
from idealgas.log import DamageError, Log
from idealgas.statistics.estimates import Estimate, ks_distance
from idealgas.theory.conserved import centre_of_mass_velocity

ROWS = 2**20
"""Largest number of event rows that are read for the state, and as many again for the pressure."""

CHECKPOINTS = 256
"""Number of recent checkpoints whose sums give the pressure of a log without events."""

BINS, HIGHEST = 20, 4.0


@dataclass(frozen=True)
class Status:
    """Latest state of the gas in a log.

    Attributes:
        time: end of the log, time.
        rows: number of event rows; None if the log has no events.
        events: number of events so far.
        temperature: mean kinetic energy of the discs, relative to a conserved motion of the centre of mass, energy.
        pressure: pressure from the virial of the latest pair collisions, energy/length²; None if it cannot be measured.
        compressibility_factor: Z = PA/NT from the same collisions; None if it cannot be measured.
        ks_distance: Kolmogorov-Smirnov distance of the speeds from the Maxwell-Boltzmann distribution; None if no disc
            moves.
        edges: (BINS + 1,), edges of the bins of the speeds, in units of √(T/m).
        density: (BINS,), measured probability density of these speeds; None if no disc moves.
        expected: (BINS,), Maxwell-Boltzmann density.
        caveats: caveats on averages over this gas.
    """

    time: float
    rows: int | None
    events: int
    temperature: float
    pressure: Estimate | None
    compressibility_factor: Estimate | None
    ks_distance: float | None
    edges: np.ndarray
    density: np.ndarray | None
    expected: np.ndarray
    caveats: tuple[str, ...]


def status(log: Log) -> Status:
    """Return the status of a log, from its latest state and a limited number of recent events."""
    seen = _time_seen(log)
    state, mass = log.state_at(seen), log.discs.mass
    squares = (mass * ((state.velocity - centre_of_mass_velocity(log.scene, log.discs)) ** 2).sum(axis=1))[state.inside]
    temperature = float(squares.mean() / 2) if len(squares) else 0.0
    edges = np.linspace(0, HIGHEST, BINS + 1)
    speeds = np.sqrt(squares / temperature) if temperature > 0 else None
    p, z = _pressure(log, seen)
    return Status(
        time=log.end_time,
        rows=len(log) if log.has_events else None,
        events=log.counts["events"],
        temperature=temperature,
        pressure=p,
        compressibility_factor=z,
        ks_distance=None if speeds is None else ks_distance(speeds, _reduced_speed_cdf),
        edges=edges,
        density=None if speeds is None else np.histogram(speeds, edges)[0] / len(speeds) / np.diff(edges),
        expected=np.diff(_reduced_speed_cdf(edges)) / np.diff(edges),
        caveats=log_caveats(log),
    )


def _time_seen(log: Log) -> float:
    """Return the time of the state that is read: the end of the log, or ROWS rows after the last checkpoint."""
    if not log.has_events:
        return float(log.checkpoints.times[-1]) if len(log.checkpoints) else log.start_time
    last = int(log.checkpoints.rows[-1]) + ROWS if len(log.checkpoints) else ROWS
    if len(log) <= last:
        return log.end_time
    return float(next(log.chunks(("time",), last - 1, last)).time[0])


def _pressure(log: Log, seen: float) -> tuple[Estimate | None, Estimate | None]:
    """Return P and Z from the pair collisions since a checkpoint at most ROWS event rows before time `seen`.

    If the log has no events, P and Z follow from the sums in its recent samples, if it contains such sums.
    """
    times = log.checkpoints.times
    if log.has_events:
        first = int(log.checkpoints.rows.searchsorted(log.row_at(seen) - ROWS))
    else:
        first = max(len(times) - CHECKPOINTS, 0)
    start = times[min(first, len(times) - 1)] if len(times) else log.start_time
    try:
        routes = pressure(log, float(start), seen).routes
    except DamageError:
        raise
    except UserError:
        return None, None
    return next(
        ((route.pressure, route.compressibility_factor) for route in routes if route.name == PAIRS), (None, None)
    )


def _reduced_speed_cdf(speed: np.ndarray) -> np.ndarray:
    return 1 - np.exp(-(speed**2) / 2)
