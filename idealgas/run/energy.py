"""The energy of a gas and of what acts on it, and what of it is conserved."""

from typing import NamedTuple

import numpy as np

from idealgas.effects.bundle import Effects, present
from idealgas.physics.exact_sum import values
from idealgas.state import Gas


class Energy(NamedTuple):
    """The energy of a gas by its parts.

    kinetic, rotational, potential: of the discs. piston: of motion and position of a piston with a mass. given: energy
    that walls and a heat bath gave to the discs, less what was lost at them; what a piston with a mass gave is not
    counted, as its own energy is. lost: what collisions between discs, and with a piston with a mass, have lost.
    """

    kinetic: float
    rotational: float = 0.0
    potential: float = 0.0
    piston: float = 0.0
    given: float = 0.0
    lost: float = 0.0

    @property
    def gas(self) -> float:
        """Of the discs alone."""
        return self.kinetic + self.rotational + self.potential

    @property
    def balance(self) -> float:
        """What stays the same: discs and piston with what was lost, less what came from outside."""
        return self.gas + self.piston + self.lost - self.given

    @property
    def scale(self) -> float:
        """Size of the largest part, with which a drift compares."""
        return max(map(abs, self))


def energy_of(gas: Gas, effects: Effects, local_time: float = 0.0) -> Energy:
    """Energy of a gas; local_time: of the gas, from the start of the epoch."""
    by_wall = np.zeros(0) if effects.wall_energy is None else values(effects.wall_energy)
    losses = np.zeros(0) if effects.dissipated is None else values(effects.dissipated)
    from_bath = np.zeros(0) if effects.bath_energy is None else values(effects.bath_energy)
    given, lost, parts = float(by_wall.sum() + from_bath.sum()), float(losses[:1].sum()), {}
    for effect, state in present(effects):
        if effect.energy is not None:
            parts[effect.energy.part] = effect.energy.of(state, gas, local_time)
        if (wall := effect.own_wall(state)) is not None:
            given -= float(by_wall[wall : wall + 1].sum())
            lost += float(losses[1 + wall : 2 + wall].sum())
    return Energy(gas.kinetic_energy, **parts, given=given, lost=lost)
