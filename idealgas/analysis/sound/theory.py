"""Theory of sound in a gas of hard discs: the equation of state, and Enskog's transport coefficients."""

import math
from typing import NamedTuple

from idealgas.analysis.core.ensemble import ensemble
from idealgas.analysis.sound.law import Decay, Fluid
from idealgas.analysis.theory import hard_discs
from idealgas.log import Log

ERRORS = Fluid(speed=0.001, damping=0.05, spreading=0.1, exponent=0.001)
"""Relative errors of theory for long waves: those of the equation of state and of Enskog's coefficients."""

FASTER = 0.15
"""Sound of waves of finite length is faster than theory by up to this part of Γk/c: measured at φ = 0.3 with 300, 600
and 2400 discs, 2.6 ± 0.7 %, 1.9 ± 0.2 % and 1.3 ± 0.4 %. In two dimensions currents have long tails, so that what is
neglected here is not small as k²."""


class Expected(NamedTuple):
    """What is expected of a wave.

    law: from which fits start. error: relative errors of its fluid; None where it does not count as theory.
    """

    law: Decay
    error: Fluid | None

    def theory(self, name: str) -> tuple[float | None, float]:
        """Value of a quantity of the fluid and its error; None and 0 without a theory."""
        value = getattr(self.law.fluid, name)
        return (None, 0.0) if self.error is None else (value, value * getattr(self.error, name))


def expected_sound(log: Log, k: float) -> Expected:
    """What is expected of waves with the wave number k, 1/length, in the gas of a log."""
    gas, temperature = log.discs, ensemble(log).temperature
    phi, mass, diameter = gas.packing_fraction, float(gas.mass[0]), 2 * float(gas.radius[0])
    size = 1 / float(hard_discs.inverse_compressibility(phi))
    law = Decay(size, k, sound_of_discs(phi, temperature, mass, diameter))
    short = FASTER * law.fluid.damping * k / law.fluid.speed
    errors = Fluid(*(math.hypot(error, short) for error in ERRORS))
    return Expected(law, errors if phi <= hard_discs.HIGHEST else None)


def sound_of_discs(phi: float, temperature: float, mass: float, diameter: float) -> Fluid:
    """Fluid of hard discs, of a packing fraction φ up to 0.62: c² = (T/m)(d(φZ)/dφ + Z²), γ = 1 + Z²/(d(φZ)/dφ)."""
    z, slope = float(hard_discs.compressibility_factor(phi)), float(hard_discs.inverse_compressibility(phi))
    density, gamma = 4 * phi / (math.pi * diameter**2), 1 + z**2 / slope
    state = diameter, density, temperature, mass, hard_discs.fluid_contact_value(phi)
    viscous = hard_discs.enskog_viscosity(*state) + hard_discs.enskog_bulk_viscosity(*state)
    spreading = hard_discs.enskog_conductivity(*state) / (density * gamma)  # c_P = γ for each disc
    damping = (viscous / (density * mass) + (gamma - 1) * spreading) / 2
    return Fluid(math.sqrt(temperature / mass * (slope + z**2)), damping, spreading, gamma)
