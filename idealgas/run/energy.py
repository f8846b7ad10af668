"""Energy account of a run: the terms of the energy, and their balance, which is conserved."""

from typing import NamedTuple

import numpy as np

from idealgas.effects.bundle import Effects, energy_parts, present
from idealgas.physics.exact_sum import values
from idealgas.state import Gas


class Energy(NamedTuple):
    """Terms of the energy, mass length²/time².

    Attributes:
        kinetic: kinetic energy of the discs.
        rotational: rotational energy of the discs.
        potential: potential energy of the discs.
        piston: kinetic and potential energy of the pistons of finite mass.
        given: energy given to the discs by walls, by a heat bath, and by changes in potentials or velocities, minus the
            losses at walls. Pistons of finite mass are not included, because their energy is counted separately.
        lost: energy lost in collisions between discs, and in collisions of discs with pistons of finite mass.
    """

    kinetic: float
    rotational: float = 0.0
    potential: float = 0.0
    piston: float = 0.0
    given: float = 0.0
    lost: float = 0.0

    @property
    def gas(self) -> float:
        """Energy of the discs."""
        return self.kinetic + self.rotational + self.potential

    @property
    def balance(self) -> float:
        """Conserved energy: energy of discs and pistons plus losses, minus the energy given from outside."""
        return self.gas + self.piston + self.lost - self.given

    @property
    def scale(self) -> float:
        """Largest absolute value of a term; an energy drift is given relative to this value."""
        return max(map(abs, self))


def energy_of(gas: Gas, effects: Effects, local_time: float = 0.0) -> Energy:
    """Return the energy account of a gas; local_time: time of the gas since the start of the epoch."""
    by_wall = np.zeros(0) if effects.wall_energy is None else values(effects.wall_energy)
    losses = np.zeros(0) if effects.dissipated is None else values(effects.dissipated)
    energies = [values(sums) for sums in (effects.bath_energy, effects.step_energy) if sums is not None]
    given, lost = float(by_wall.sum() + sum(map(np.sum, energies))), float(losses[:1].sum())
    for effect, state in present(effects):
        for wall in effect.own_walls(state):
            given -= float(by_wall[wall : wall + 1].sum())
            lost += float(losses[1 + wall : 2 + wall].sum())
    return Energy(gas.kinetic_energy, **energy_parts(effects, gas, local_time), given=given, lost=lost)
