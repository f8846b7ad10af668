"""Theory of sound in a gas of hard discs: the equation of state, and Enskog's transport coefficients."""

import math
from typing import NamedTuple

from idealgas.analysis.core.equilibrium import ensemble
from idealgas.analysis.sound.law import Decay, Fluid, decay
from idealgas.analysis.theory import hard_discs
from idealgas.log import Log

ERRORS = Fluid(speed=0.003, damping=0.08, spreading=0.1, exponent=0.05)
"""Relative errors of theory. That of γ includes what the amplitudes of waves of finite length have beyond it."""


class Expected(NamedTuple):
    """What is expected of a wave: its law, which fits start from, and the fluid by theory, None outside its range."""

    law: Decay
    fluid: Fluid | None


def expected_sound(log: Log, k: float) -> Expected:
    """What is expected of waves with the wave number k, 1/length, in the gas of a log."""
    gas, temperature = log.discs, ensemble(log).temperature
    phi, mass, diameter = gas.packing_fraction, float(gas.mass[0]), 2 * float(gas.radius[0])
    fluid = sound_of_discs(phi, temperature, mass, diameter)
    size = 1 / float(hard_discs.inverse_compressibility(phi))
    return Expected(decay(fluid, size, k), fluid if phi <= hard_discs.HIGHEST else None)


def sound_of_discs(phi: float, temperature: float, mass: float, diameter: float) -> Fluid:
    """Fluid of hard discs, of a packing fraction φ up to 0.62: c² = (T/m)(d(φZ)/dφ + Z²), γ = 1 + Z²/(d(φZ)/dφ)."""
    z, slope = float(hard_discs.compressibility(phi)), float(hard_discs.inverse_compressibility(phi))
    density, gamma = 4 * phi / (math.pi * diameter**2), 1 + z**2 / slope
    state = diameter, density, temperature, mass, hard_discs.fluid_contact_value(phi)
    viscous = hard_discs.enskog_viscosity(*state) + hard_discs.enskog_bulk_viscosity(*state)
    spreading = hard_discs.enskog_conductivity(*state) / (density * gamma)  # c_P = γ for each disc
    damping = (viscous / (density * mass) + (gamma - 1) * spreading) / 2
    return Fluid(math.sqrt(temperature / mass * (slope + z**2)), damping, spreading, gamma)
