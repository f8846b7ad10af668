"""The energy of a gas and of what acts on it, and what of it is conserved."""

from typing import NamedTuple

from idealgas.gas.state import Gas
from idealgas.physics.effects import Effects
from idealgas.run.effects.bundle import present


class Energy(NamedTuple):
    """The energy of a gas by its parts.

    kinetic, rotational, potential: of the discs. piston: of motion and position of a piston with a mass. given: energy
    that walls gave to the discs; what a piston with a mass gave is not counted, as its own energy is.
    """

    kinetic: float
    rotational: float = 0.0
    potential: float = 0.0
    piston: float = 0.0
    given: float = 0.0

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
    given = 0.0 if effects.wall_energy is None else float(effects.wall_energy.sum())
    parts = {}
    for effect, state in present(effects):
        if effect.energy is not None:
            parts[effect.energy.part] = effect.energy.of(state, gas, local_time)
        if effects.wall_energy is not None and (wall := effect.own_wall(state)) is not None:
            given -= float(effects.wall_energy[wall])
    return Energy(gas.kinetic_energy, **parts, given=given)


def is_conserved(effects: Effects) -> bool:
    """Whether the balance is: no energy is lost between discs, or between a disc and a wall with energy of its own."""
    return all(effect.conserves(effects) for effect, _ in present(effects))
