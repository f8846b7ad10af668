"""Density waves in a fluid in linear hydrodynamics: heat diffusion and sound."""

import math
from typing import NamedTuple

import numpy as np

from idealgas.theory import enskog, hard_discs

MOST_CALLS = 4000
"""Number of evaluations of the correlation function after which a fit is abandoned."""


class Fluid(NamedTuple):
    """Properties of a fluid that enter hydrodynamics.

    Attributes:
        speed: speed of sound c, length/time.
        damping: sound damping Γ, length²/time.
        spreading: thermal diffusivity χ, length²/time.
        exponent: adiabatic exponent γ (no unit).
    """

    speed: float
    damping: float
    spreading: float
    exponent: float

    @property
    def viscosity(self) -> float:
        """Longitudinal kinematic viscosity ν = 2Γ - (γ - 1)χ, length²/time."""
        return 2 * self.damping - (self.exponent - 1) * self.spreading


class Decay(NamedTuple):
    """Correlation ⟨ρ(t)ρ*(0)⟩ of a density wave.

    Attributes:
        size: value at t = 0 (no unit).
        k: wave number, 1/length.
        fluid: the fluid.
    """

    size: float
    k: float
    fluid: Fluid

    def at(self, time: np.ndarray) -> np.ndarray:
        """Return the correlation at times (L,)."""
        return self.size * correlation(time, self.k, self.fluid)


def correlation(time: np.ndarray, k: float, fluid: Fluid) -> np.ndarray:
    """Return ⟨ρ(t)ρ*(0)⟩/⟨ρρ*⟩ (L,) at times (L,) of a wave with wave number k, 1/length.

    Its Laplace transform is (s² + bs + γχνk⁴ + (1 - 1/γ)c²k²)/(s³ + bs² + (c²k² + γχνk⁴)s + χc²k⁴) with b = (ν + γχ)k²:
    Boon & Yip, Molecular Hydrodynamics (1980), section 5.3. To lowest order in k, the poles are -χk² and -Γk² ± ick.
    """
    gamma, square = fluid.exponent, (fluid.speed * k) ** 2
    heat, viscous = fluid.spreading * k**2, fluid.viscosity * k**2
    both, mixed = viscous + gamma * heat, gamma * heat * viscous
    poles = np.roots([1.0, both, square + mixed, heat * square])
    above = np.polyval([1.0, both, mixed + (1 - 1 / gamma) * square], poles)
    below = np.polyval([3.0, 2 * both, square + mixed], poles)
    return ((above / below) @ np.exp(np.outer(poles, time))).real


def fit(time: np.ndarray, measured: np.ndarray, guess: Decay, thermal: float) -> Decay | None:
    """Return the least-squares fit to a correlation (L,) at times (L,); None if the fit fails.

    The size of a long wave is nT times the isothermal compressibility, γT/(mc²), so that γ is not a free parameter.
    thermal: T/m, length²/time².
    """
    from scipy.optimize import curve_fit  # slow to import, and needed only for sound

    def fluid(size: float, speed: float, damping: float, spreading: float) -> Fluid:
        return Fluid(speed, damping, spreading, max(size * speed**2 / thermal, 1 + 1e-9))

    def law(time: np.ndarray, size: float, *parameters: float) -> np.ndarray:
        return size * correlation(time, guess.k, fluid(size, *parameters))

    start = (guess.size, *guess.fluid[:3])
    bounds = [1e-3 * abs(value) for value in start], np.inf
    try:
        best, _ = curve_fit(law, time, measured, start, bounds=bounds, max_nfev=MOST_CALLS, x_scale=start)
    except RuntimeError:
        return None
    return Decay(float(best[0]), guess.k, fluid(*map(float, best)))


def sound_of_discs(phi: float, temperature: float, mass: float, diameter: float) -> Fluid:
    """Return the properties of the hard-disc fluid at a packing fraction φ of at most 0.62.

    c² = (T/m)(d(φZ)/dφ + Z²) and γ = 1 + Z²/(d(φZ)/dφ).
    """
    z, slope = float(hard_discs.compressibility_factor(phi)), float(hard_discs.inverse_compressibility(phi))
    density, gamma = 4 * phi / (math.pi * diameter**2), 1 + z**2 / slope
    state = diameter, density, temperature, mass, hard_discs.fluid_contact_value(phi)
    viscous = enskog.viscosity(*state) + enskog.bulk_viscosity(*state)
    spreading = enskog.conductivity(*state) / (density * gamma)  # c_P = γ per disc
    damping = (viscous / (density * mass) + (gamma - 1) * spreading) / 2
    return Fluid(math.sqrt(temperature / mass * (slope + z**2)), damping, spreading, gamma)
