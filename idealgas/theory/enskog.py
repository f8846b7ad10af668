"""Transport coefficients of dense gases of equal discs from Enskog theory, and the errors of this theory."""

import math

import numpy as np

ERRORS = {
    "diffusion": ((0.0, 0.1, 0.3, 0.45), (0.0, 0.11, 0.25, 0.31)),
    "viscosity": ((0.0, 0.4, 0.5, 0.6), (0.02, 0.025, 0.04, 0.16)),
    "conductivity": ((0.0, 0.4, 0.5, 0.6), (0.02, 0.025, 0.025, 0.05)),
    "bulk viscosity": ((0.0, 0.6), (0.03, 0.03)),
}
"""Packing fractions, and relative differences of measured transport coefficients from Enskog theory at these φ.

The values for self-diffusion are for 500 discs; they increase with N, because Enskog theory lacks the long-time tail.
Above φ = 0.45 the difference decreases again, to 0.13 at 0.55 and 0.04 at 0.62. The other coefficients are for 250
discs, with a resolution of 1.5 to 2 %. Near freezing the viscosity is far above the Enskog value: García-Rojo, Luding &
Brey, Phys. Rev. E 74, 061305 (2006).
"""


def relative_error(quantity: str, packing_fraction: float) -> float:
    """Return the relative error of a transport coefficient; quantity: a key of ERRORS."""
    return float(np.interp(packing_fraction, *ERRORS[quantity]))


def diffusion(diameter: float, number_density: float, temperature: float, mass: float, chi: float) -> float:
    """Return the diffusion coefficient D = T/mΓ = √(T/πm)/(2σnχ), length²/time.

    This is the first approximation, in which the velocity correlation decays as exp(-Γt). Source: Gass, J. Chem. Phys.
    54, 1898 (1971).
    """
    return math.sqrt(temperature / (math.pi * mass)) / (2 * diameter * number_density * chi)


def viscosity(diameter: float, number_density: float, temperature: float, mass: float, chi: float) -> float:
    """Return the shear viscosity η₀ (1/χ + y + 0.8729 χy²), mass/time.

    y = πnσ²/2 and η₀ = 1.022 √(mT/π)/2σ: Gass, J. Chem. Phys. 54, 1898 (1971).
    """
    y = math.pi * number_density * diameter**2 / 2
    dilute = 1.022 * math.sqrt(mass * temperature / math.pi) / (2 * diameter)
    return dilute * (1 / chi + y + 0.8729 * chi * y * y)


def bulk_viscosity(diameter: float, number_density: float, temperature: float, mass: float, chi: float) -> float:
    """Return the bulk viscosity ζ = (4/π) χ y² √(mT/π)/2σ, mass/time; y = πnσ²/2.

    It is exact within Enskog theory, which describes collisions of discs whose positions are distributed as in
    equilibrium. Gass, J. Chem. Phys. 54, 1898 (1971), writes it as 1.246 times the η₀ of `viscosity`.
    """
    y = math.pi * number_density * diameter**2 / 2
    return 4 / math.pi * chi * y * y * math.sqrt(mass * temperature / math.pi) / (2 * diameter)


def conductivity(diameter: float, number_density: float, temperature: float, mass: float, chi: float) -> float:
    """Return the thermal conductivity λ₀ (1/χ + 3y/2 + 0.8718 χy²), 1/time; y = πnσ²/2.

    λ₀ = 1.029 (2/σ) √(T/πm): Gass, J. Chem. Phys. 54, 1898 (1971).
    """
    y = math.pi * number_density * diameter**2 / 2
    dilute = 1.029 * 2 / diameter * math.sqrt(temperature / (math.pi * mass))
    return dilute * (1 / chi + 1.5 * y + 0.8718 * chi * y * y)
