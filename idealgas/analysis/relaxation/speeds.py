"""Speed distributions at several instants: numbers of discs in classes of speed."""

import math
from dataclasses import dataclass
from itertools import count, takewhile
from typing import Annotated

import numpy as np

from idealgas.analysis.core.ensemble import ensemble
from idealgas.analysis.core.fields import Key
from idealgas.analysis.core.statistics import ks_distance
from idealgas.analysis.core.stream import span
from idealgas.analysis.relaxation.acceptance import last_trial
from idealgas.analysis.relaxation.velocities import (
    check_steady,
    collisions_per_disc,
    reduced_energy,
    reduced_energy_cdf,
)
from idealgas.analysis.theory.distributions import SpeedLaw
from idealgas.errors import UserError
from idealgas.log import Log

CLASSES = 0.3 * np.arange(9)
"""Lower ends of the classes of speed, in units of the root-mean-square speed; the last class has no upper end."""

MOST_INSTANTS = 10_000


@dataclass(frozen=True)
class SpeedDistributions:
    """Speed distributions at K instants in C classes of speed.

    Speeds are relative to the centre of mass along axes where momentum is conserved. time: (K,), times. trials: (K,),
    Monte Carlo trials until then; None for a method without trials. collisions: (K,), collisions per disc until then.
    distance: (K,), Kolmogorov-Smirnov distance from Maxwell-Boltzmann's distribution. rms: root-mean-square speed,
    length/time. edges: (C,), lower ends of the classes, length/time. counts: (K, C), numbers of discs. expected: (C,),
    numbers of discs by Maxwell-Boltzmann's distribution.
    """

    time: np.ndarray
    trials: np.ndarray | None
    collisions: Annotated[np.ndarray, Key("collisions_per_disc")]
    distance: np.ndarray
    rms: Annotated[float, Key("rms_speed")]
    edges: Annotated[np.ndarray, Key("speed_from")]
    counts: np.ndarray
    expected: Annotated[np.ndarray, Key("maxwell_boltzmann")]


def speed_distributions(
    log: Log, every: float, start: float | None = None, end: float | None = None
) -> SpeedDistributions:
    """Count discs by speed at the start and after every `every` trials (Monte Carlo) or units of time (other methods).

    Raises:
        UserError: if there would be more than MOST_INSTANTS instants, or if the gas does not relax (`check_steady`).
    """
    check_steady(log)
    first, last = span(log, start, end)
    trials = None
    if "trial" in log.columns:
        trials, time = _at_trials(log, every, first, last)
    else:
        _check_number((last - first) / every)
        time = np.array(list(takewhile(lambda t: t <= last, (first + k * every for k in count()))))
    gas, equilibrium = log.discs, ensemble(log)
    rms = math.sqrt(((gas.velocity - equilibrium.centre_of_mass_velocity) ** 2).sum() / len(gas))
    edges = rms * CLASSES
    counts, distance = [], []
    for state in log.frames(time):
        speed = np.hypot(*(state.velocity - equilibrium.centre_of_mass_velocity).T)
        counts.append(np.histogram(speed, [*edges, math.inf])[0])
        distance.append(ks_distance(reduced_energy(log, state.velocity, equilibrium), reduced_energy_cdf))
    species = zip(equilibrium.of_species, range(len(gas.species_names)), strict=True)
    expected = np.zeros(len(edges))
    for temperature, s in species:
        members = gas.species == s
        law = SpeedLaw(float(temperature), float(gas.mass[members][0]))
        expected += members.sum() * np.diff(law.cdf(edges), append=1.0)
    return SpeedDistributions(
        time, trials, collisions_per_disc(log, time), np.array(distance), rms, edges, np.array(counts), expected
    )


def _at_trials(log: Log, every: float, first: float, last: float) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of trials, and time of the last collision up to each of them."""
    total = log.summary["trials"] if log.complete else last_trial(log)
    _check_number(total / every)
    wanted = np.arange(0, total + 1, max(int(every), 1))
    time = np.full(len(wanted), log.start_time)
    for rows in log.chunks(("time", "trial")):
        done = np.searchsorted(rows.trial, wanted.astype(np.uint64), "right")
        time = np.where(done > 0, rows.time[np.maximum(done - 1, 0)], time)
    inside = (first <= time) & (time <= last)
    return wanted[inside], time[inside]


def _check_number(instants: float) -> None:
    if instants > MOST_INSTANTS:
        raise UserError(f"{instants:.3g} instants are too many for a table (allowed <= {MOST_INSTANTS})")
