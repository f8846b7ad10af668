"""Reduced energies of discs, whose probability density in equilibrium is exp(-x), and collisions per disc."""

import numpy as np

from idealgas.analysis.core.ensemble import Ensemble
from idealgas.errors import UserError
from idealgas.log import Log


def check_steady(log: Log) -> None:
    """Check that the velocities of a log can relax to Maxwell-Boltzmann's distribution.

    Raises:
        UserError: if the log has no events, if the kinetic energy of its discs is not constant, or if no disc moves.
    """
    if not log.has_events:
        raise UserError(f"{log.path}: has no events (made with log.events = false)")
    if restless := log.scene.lacking("conserves_motion"):
        raise UserError(f"{log.path}: the kinetic energy of its discs is not constant: {', '.join(restless)}")
    if not log.discs.temperature > 0:
        raise UserError(f"{log.path}: no disc moves")


def collisions_per_disc(log: Log, time: np.ndarray) -> np.ndarray:
    """Mean number (K,) of collisions of a disc from time[0] up to each time; a collision counts for both discs."""
    rows_until = np.zeros(len(time))
    for rows in log.chunks(("time", "partner"), log.row_at(time[0], "right"), log.row_at(time[-1], "right")):
        instant = np.searchsorted(time, rows.time[rows.partner >= 0])
        rows_until += np.bincount(instant, minlength=len(time))
    return np.cumsum(rows_until) / len(log.discs)


def reduced_energy(log: Log, velocity: np.ndarray, equilibrium: Ensemble) -> np.ndarray:
    """Reduced energy m v²/2T of every disc (no unit), with its mean kinetic energy T in equilibrium."""
    gas = log.discs
    square = ((velocity - equilibrium.centre_of_mass_velocity) ** 2).sum(axis=1)
    return gas.mass * square / (2 * equilibrium.of_species[gas.species])


def reduced_energy_cdf(energy: np.ndarray) -> np.ndarray:
    """Distribution function of reduced energies in equilibrium, 1 - exp(-x)."""
    return -np.expm1(-energy)
