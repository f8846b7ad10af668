"""What is looked at of velocities that come to equilibrium: reduced energies, whose law is exp(-x), at instants."""

import numpy as np

from idealgas.analysis.core.equilibrium import Ensemble
from idealgas.errors import UserError
from idealgas.log import Log


def check_steady(log: Log) -> None:
    """UserError if there is no law of Maxwell and Boltzmann that the discs of the log tend to, or no event in it."""
    if not log.has_events:
        raise UserError(f"{log.path}: has no events (made with log.events = false)")
    if restless := log.scene.lacking("conserves_motion"):
        raise UserError(f"{log.path}: the kinetic energy of its discs is not constant: {', '.join(restless)}")
    if not log.discs.temperature > 0:
        raise UserError(f"{log.path}: no disc moves")


def collisions_per_disc(log: Log, time: np.ndarray) -> np.ndarray:
    """(K,) collisions that a disc had on average from time[0] up to each of the times; a collision counts for both."""
    rows_until = np.zeros(len(time))
    for rows in log.chunks(("time", "partner"), log.row_at(time[0], "right"), log.row_at(time[-1], "right")):
        place = np.searchsorted(time, rows.time[rows.partner >= 0])
        rows_until += np.bincount(place, minlength=len(time))
    return np.cumsum(rows_until) / len(log.discs)


def reduced_energy(log: Log, velocity: np.ndarray, equilibrium: Ensemble) -> np.ndarray:
    """m v²/2T of every disc, with the T that it tends to."""
    gas = log.discs
    square = ((velocity - equilibrium.drift) ** 2).sum(axis=1)
    return gas.mass * square / (2 * equilibrium.of_species[gas.species])


def reduced_energy_cdf(energy: np.ndarray) -> np.ndarray:
    """Distribution function of reduced energies in equilibrium, 1 - exp(-x)."""
    return -np.expm1(-energy)
