"""How a wave of density goes on, by the hydrodynamics of a fluid: a part that spreads as heat does, and sound.

The rates s of its modes solve s³ + (ν + γχ)k² s² + (c² + γχν k²)k² s + χc² k⁴ = 0 for the speed of sound c, the
longitudinal kinematic viscosity ν, the thermal diffusivity χ and the adiabatic exponent γ: Boon & Yip, Molecular
Hydrodynamics (1980), chapter 5. To lowest order in k they are -χk² and -Γk² ± ick with Γ = (ν + (γ - 1)χ)/2.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import curve_fit

MOST_CALLS = 4000
"""Evaluations of the law after which a fit is given up."""

ROUNDS = 50
"""Rounds after which c, χ and ν no longer change: each makes them more exact by a factor of about Γk²/ω, squared."""


class Fluid(NamedTuple):
    """What hydrodynamics takes of a fluid.

    speed: of sound, c, length/time. damping: of sound, Γ, length²/time. spreading: thermal diffusivity χ, length²/time.
    exponent: adiabatic exponent γ (no unit).
    """

    speed: float
    damping: float
    spreading: float
    exponent: float

    @property
    def viscosity(self) -> float:
        """Longitudinal kinematic viscosity ν, length²/time."""
        return 2 * self.damping - (self.exponent - 1) * self.spreading


class Decay(NamedTuple):
    """Correlation ⟨ρ(t)ρ*(0)⟩ of a wave of density.

    size: at t = 0 (no unit). heat: part of it that spreads as heat does (no unit), (γ - 1)/γ. spreading: rate of that,
    1/time. damping: rate at which sound dies out, 1/time. frequency: of sound, 1/time.
    """

    size: float
    heat: float
    spreading: float
    damping: float
    frequency: float

    def at(self, time: np.ndarray) -> np.ndarray:
        """Correlation at times (L,)."""
        return correlation(time, *self)

    def fluid(self, k: float) -> Fluid:
        """Fluid in which a wave with the wave number k, 1/length, has these rates."""
        gamma, heat, sound = 1 / (1 - self.heat), self.spreading, self.damping**2 + self.frequency**2
        square, spreading = sound, heat
        for _ in range(ROUNDS):
            viscosity = heat + 2 * self.damping - gamma * spreading
            square = max(sound + 2 * heat * self.damping - gamma * spreading * viscosity, sound / 4)
            spreading = heat * sound / square
        damping = (heat + 2 * self.damping - spreading) / 2
        return Fluid(math.sqrt(square) / k, damping / k**2, spreading / k**2, gamma)


def decay(fluid: Fluid, size: float, k: float) -> Decay:
    """How a wave with the wave number k, 1/length, goes on in a fluid; size: of its correlation at t = 0."""
    gamma, c, chi, nu = fluid.exponent, fluid.speed * k, fluid.spreading * k**2, fluid.viscosity * k**2
    rates = np.roots([1.0, nu + gamma * chi, c**2 + gamma * chi * nu, chi * c**2])
    heat, sound = rates[np.argmin(np.abs(rates.imag))], rates[np.argmax(rates.imag)]
    return Decay(size, (gamma - 1) / gamma, -float(heat.real), -float(sound.real), float(sound.imag))


def correlation(
    time: np.ndarray, size: float, heat: float, spreading: float, damping: float, frequency: float
) -> np.ndarray:
    """The correlation of `Decay` at times (L,). Its slope at t = 0 is 0, as that of every correlation is."""
    turn = (heat / (1 - heat) * spreading + damping) / frequency
    sound = np.cos(frequency * time) + turn * np.sin(frequency * time)
    return size * (heat * np.exp(-spreading * time) + (1 - heat) * np.exp(-damping * time) * sound)


def fit(time: np.ndarray, found: np.ndarray, guess: Decay) -> Decay | None:
    """The law that is nearest to a correlation (L,) at times (L,), by least squares; None if there is none."""
    least = [0.0, 0.0, 0.0, 0.0, 1e-3 * guess.frequency]
    most = [np.inf, 0.99, np.inf, np.inf, np.inf]
    try:
        best, _ = curve_fit(correlation, time, found, guess, bounds=(least, most), max_nfev=MOST_CALLS, x_scale=guess)
    except RuntimeError:
        return None
    return Decay(*map(float, best))
