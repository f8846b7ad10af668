"""What a gas conserves, and how the energy is shared out under that: the ensemble its equilibrium belongs to."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from idealgas.analysis.core.composition import Composition, composition
from idealgas.errors import UserError
from idealgas.log import Log


@dataclass(frozen=True)
class Ensemble:
    """A gas of fixed energy, and of fixed momentum where no wall takes any; or one at the temperature of its walls.

    drift: (2,), velocity from which the others count, see `drift`. dof: D, degrees of freedom of motion and spin that
    share the energy, infinite in a heat bath. temperature: 2E/D. of_species: (S,), mean kinetic energy of a disc:
    T(1 - m/M) where the discs, of mass M in all, keep their momentum (half as much less where they keep one component),
    as a heavy disc's share of it is not free.
    """

    drift: np.ndarray
    dof: float
    temperature: float
    of_species: np.ndarray


def kept_momentum(log: Log) -> np.ndarray:
    """(2,) bool, directions along which nothing takes momentum from the discs; all, where discs have no positions.

    Smooth walls take none along themselves; thermal and rough ones do.
    """
    return np.array(log.scene.properties.conserves_momentum if log.has_positions else (True, True))


def drift(log: Log) -> np.ndarray:
    """(2,) velocity of the centre of mass where it stays as it is, else 0."""
    gas = log.discs
    return np.where(kept_momentum(log), gas.mass @ gas.velocity / gas.mass.sum(), 0.0)


def ensemble(log: Log) -> Ensemble:
    """Of the discs of a log. UserError if their energy is not known beforehand."""
    found = known_ensemble(log)
    if found is None:
        causes = log.scene.lacking("conserves_energy") or log.scene.lacking("isolated")
        raise UserError(f"{log.path}: no temperature is known beforehand under {', '.join(causes)}")
    return found


def known_ensemble(log: Log) -> Ensemble | None:
    """The same, None if the energy of motion and spin is neither fixed nor set by walls of one temperature."""
    properties, gas, mass = log.scene.properties, log.discs, composition(log.discs).mass
    if not properties.conserves_energy or len(properties.temperatures) > 1:
        return None
    kept, frame = kept_momentum(log), drift(log)
    dof = 2 * len(gas) - int(kept.sum())
    energy = float((gas.mass * ((gas.velocity - frame) ** 2).sum(axis=1)).sum())  # twice
    if log.inertia is not None:
        dof += len(gas)
        spin = log.state_at(log.start_time).angular_velocity
        energy += 0.0 if spin is None else float((log.inertia * spin**2).sum())
    share = 1 - kept.mean() * mass / gas.mass.sum()
    if properties.isolated:
        return Ensemble(frame, dof, energy / dof, energy / dof * share)
    (temperature,) = properties.temperatures
    return Ensemble(frame, math.inf, temperature, temperature * share)


def column_temperature(log: Log, axis: int, discs: Composition) -> float | None:
    """Of a gas that falls along an axis: its walls' own, or what its energy at the start comes to in a dilute gas.

    None where other effects leave it unknown, and for a single disc, with which nobody shares.
    """
    properties, gas = log.scene.properties, log.discs
    if not properties.fixed_walls or not properties.elastic or log.periodic[1 - axis] or len(gas) == 1:
        return None
    if walls := properties.temperatures:
        return min(walls) if len(walls) == 1 else None
    if not properties.lossless:
        return None
    g = log.gravity[axis]
    start = log.state_at(log.start_time)
    energy = gas.kinetic_energy - float(gas.mass @ start.position[:, axis]) * g
    spins = 0.0
    if log.inertia is not None and start.angular_velocity is not None:
        energy += float(log.inertia @ start.angular_velocity**2) / 2
        spins = len(gas) / 2
    height = log.box[axis] - 2 * discs.radius

    def excess(t: float) -> float:
        x = discs.mass * g * height / t
        with np.errstate(over="ignore"):
            above = height * (1 / -np.expm1(-x) - 1 / x)  # mean of h' in (0, height) with weight exp(x h'/height)
        potential = -(discs.number * discs.mass * g * (discs.radius + above)).sum()
        return (len(gas) + spins) * t + float(potential) - energy

    lowest = -(discs.number * discs.mass * g * np.where(g < 0, discs.radius, log.box[axis] - discs.radius)).sum()
    scale = max(energy - float(lowest), 1e-300) / len(gas)
    return float(brentq(excess, 1e-3 * scale, 2 * scale))
