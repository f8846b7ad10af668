"""The energy of a gas and of what acts on it, and what of it is conserved."""

from typing import NamedTuple

import numpy as np

from idealgas.gas.state import Gas
from idealgas.physics.effects import Effects


class Energy(NamedTuple):
    """kinetic, rotational, potential: of the discs. piston: motion and position of one with a mass. given: what walls
    gave to the discs; a piston with a mass, whose energy counts itself, is not among them.
    """

    kinetic: float
    rotational: float
    potential: float
    piston: float
    given: float

    @property
    def gas(self) -> float:
        """Of the discs alone."""
        return self.kinetic + self.rotational + self.potential

    @property
    def balance(self) -> float:
        """What stays the same where energy is conserved: discs and piston, less what walls gave."""
        return self.gas + self.piston - self.given

    @property
    def scale(self) -> float:
        """Size of the largest part, with which a drift compares."""
        return max(map(abs, self))


def energy_of(gas: Gas, effects: Effects, local_time: float = 0.0) -> Energy:
    """Energy of a gas; local_time: of the gas, from the start of the epoch."""
    rotational = potential = piston = 0.0
    given = 0.0 if effects.wall_energy is None else float(effects.wall_energy.sum())
    if effects.rotation is not None:
        rotational = float((0.5 * effects.rotation.inertia * effects.rotation.omega**2).sum())
    if effects.gravity is not None:
        potential = -float((gas.mass * (gas.position @ np.array(effects.gravity))).sum())
    if effects.piston is not None and effects.wall_energy is not None and effects.piston[0].m > 0:
        record = effects.piston[0]
        place, velocity = piston_motion(effects.piston, local_time)
        piston = float(record.m * (0.5 * velocity**2 - record.a * place))
        given -= float(effects.wall_energy[record.side])
    return Energy(gas.kinetic_energy, rotational, potential, piston, given)


def piston_motion(piston: np.ndarray, local_time: float) -> tuple[float, float]:
    """Position and velocity of a piston at a local time from its last hit to the next."""
    record = piston[0]
    dt = local_time - record.t
    return float(record.x + record.v * dt + 0.5 * record.a * dt * dt), float(record.v + record.a * dt)


def is_conserved(effects: Effects) -> bool:
    """Whether the balance is: no energy is lost between discs, or between a disc and a piston with a mass."""
    restitution, rotation, piston = effects.restitution, effects.rotation, effects.piston
    if rotation is not None and abs(rotation.roughness) < 1:
        return False
    if restitution is not None and restitution.normal < 1:
        return False
    return not (restitution is not None and restitution.wall < 1 and piston is not None and piston[0].m > 0)
