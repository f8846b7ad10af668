"""Probability laws of a gas in equilibrium, each with `pdf`, `cdf` and `mean`.

The velocity laws take `temperature` = mean kinetic energy of the disc (two degrees of freedom, k_B = 1) and `dof` = D,
the gas's velocity degrees of freedom at fixed total energy. With D = ∞ they are Maxwell-Boltzmann's; otherwise a disc's
energy over its largest possible value TD/2 follows Beta(1, D/2 - 1): the uniform distribution on a sphere, projected.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy import special

from idealgas.analysis.theory.hard_discs import mean_speed


class Law(Protocol):
    """A continuous distribution of one quantity."""

    @property
    def mean(self) -> float: ...
    def pdf(self, x: np.ndarray) -> np.ndarray: ...
    def cdf(self, x: np.ndarray) -> np.ndarray: ...


@dataclass(frozen=True)
class EnergyLaw:
    """Kinetic energy of a disc: exponential; at fixed total energy P(> e) = (1 - 2e/TD)^(D/2 - 1)."""

    temperature: float
    dof: float = math.inf

    @property
    def mean(self) -> float:
        return self.temperature

    def pdf(self, x: np.ndarray) -> np.ndarray:
        share = np.maximum(x, 0.0) / self.temperature
        if math.isinf(self.dof):
            return np.where(np.asarray(x) < 0, 0.0, np.exp(-share) / self.temperature)
        half = self.dof / 2
        free = 1 - share / half
        possible = (np.asarray(x) >= 0) & (free > 0)
        density = (half - 1) / half * np.where(possible, free, 1.0) ** (half - 2) / self.temperature
        return np.where(possible, density, 0.0)

    def cdf(self, x: np.ndarray) -> np.ndarray:
        share = np.maximum(x, 0.0) / self.temperature
        if math.isinf(self.dof):
            return -np.expm1(-share)
        half = self.dof / 2
        return 1 - np.maximum(1 - share / half, 0.0) ** (half - 1)


@dataclass(frozen=True)
class SpeedLaw:
    """Speed of a disc: f(v) = (m v/T) exp(-m v²/2T), or its counterpart at fixed total energy."""

    temperature: float
    mass: float
    dof: float = math.inf

    @property
    def mean(self) -> float:
        return mean_speed(self.temperature, self.mass, self.dof)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        speed = np.maximum(x, 0.0)
        return EnergyLaw(self.temperature, self.dof).pdf(self.mass * speed**2 / 2) * self.mass * speed

    def cdf(self, x: np.ndarray) -> np.ndarray:
        return EnergyLaw(self.temperature, self.dof).cdf(self.mass * np.maximum(x, 0.0) ** 2 / 2)


@dataclass(frozen=True)
class ComponentLaw:
    """One velocity component: normal with variance T/m; at fixed total energy density ∝ (1 - m v²/TD)^((D - 3)/2)."""

    temperature: float
    mass: float
    dof: float = math.inf

    @property
    def mean(self) -> float:
        return 0.0

    def pdf(self, x: np.ndarray) -> np.ndarray:
        z = np.asarray(x) * math.sqrt(self.mass / self.temperature)
        if math.isinf(self.dof):
            return np.exp(-(z**2) / 2) * math.sqrt(self.mass / (2 * math.pi * self.temperature))
        norm = math.sqrt(self.mass / (self.temperature * self.dof)) / special.beta(0.5, (self.dof - 1) / 2)
        return norm * np.maximum(1 - z**2 / self.dof, 0.0) ** ((self.dof - 3) / 2)  # D > 3

    def cdf(self, x: np.ndarray) -> np.ndarray:
        z = np.asarray(x) * math.sqrt(self.mass / self.temperature)
        if math.isinf(self.dof):
            return special.ndtr(z)
        share = np.minimum(z**2 / self.dof, 1.0)
        return 0.5 + 0.5 * np.sign(z) * special.betainc(0.5, (self.dof - 1) / 2, share)


def mean_relative_speed_at(speed: np.ndarray, temperature: float, mass: float) -> np.ndarray:
    """⟨|v - u|⟩ over the velocities u of discs of `mass`, for a disc of given speed v.

    √(πT/2m) e^(-x/2) [(1 + x) I₀(x/2) + x I₁(x/2)], x = m v²/2T: the mean of a Rice distribution.
    """
    x = mass * np.asarray(speed) ** 2 / (2 * temperature)
    bessel = (1 + x) * special.i0e(x / 2) + x * special.i1e(x / 2)
    return mean_speed(temperature, mass) * bessel


@dataclass(frozen=True)
class _FlightLaw(ABC):
    """Free flight of a disc of `mass` that meets species j (`masses`) at the mean rate `rates[j]`.

    A disc of speed v collides at the rate ν(v) = Σ_j rate_j ⟨|v - u_j|⟩/⟨|w - u_j|⟩, w thermal, and leaves a collision
    with the speed density f(v) ν(v)/Γ (by reversal it is that of the discs about to collide). Partners must be met
    independently: exact in the dilute limit (Boltzmann). In denser gases discs meet again sooner: at φ = 0.1 to 0.3 the
    distribution functions were measured to be off by 0.006 at most.
    """

    temperature: float
    mass: float
    masses: tuple[float, ...]
    rates: tuple[float, ...]

    @cached_property
    def _nodes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Speed, probability weight of a flight, and ν at the nodes of a quadrature in the speed."""
        y, weight = np.polynomial.legendre.leggauss(120)
        y, weight = 3.5 * (y + 1), 3.5 * weight  # y = v √(m/2T); exp(-7²) is beyond float64
        speed = y * math.sqrt(2 * self.temperature / self.mass)
        rate = np.zeros_like(speed)
        for other, mean_rate in zip(self.masses, self.rates, strict=True):
            mean = mean_speed(self.temperature, self.mass * other / (self.mass + other))
            rate += mean_rate * mean_relative_speed_at(speed, self.temperature, other) / mean
        return speed, weight * 2 * y * np.exp(-(y**2)) * rate / sum(self.rates), rate

    @abstractmethod
    def _decay(self) -> np.ndarray:
        """Decay rate of the survival of a flight at each node: per time or per length."""

    @property
    def mean(self) -> float:
        return float((self._nodes[1] / self._decay()).sum())

    def pdf(self, x: np.ndarray) -> np.ndarray:
        decay = self._decay()
        return np.exp(-np.multiply.outer(np.asarray(x, float), decay)) @ (self._nodes[1] * decay)

    def cdf(self, x: np.ndarray) -> np.ndarray:
        return 1 - np.exp(-np.multiply.outer(np.maximum(x, 0.0), self._decay())) @ self._nodes[1]


class FreeTimeLaw(_FlightLaw):
    """Time between two successive collisions of a disc with other discs; its mean is 1/Γ."""

    def _decay(self) -> np.ndarray:
        return self._nodes[2]


class FreePathLaw(_FlightLaw):
    """Length of path between two successive collisions of a disc with other discs; its mean is ⟨v⟩/Γ."""

    def _decay(self) -> np.ndarray:
        return self._nodes[2] / self._nodes[0]


@dataclass(frozen=True)
class WaitLaw:
    """Time between successive events of the whole gas: exponential when many discs collide independently."""

    rate: float

    @property
    def mean(self) -> float:
        return 1 / self.rate

    def pdf(self, x: np.ndarray) -> np.ndarray:
        return self.rate * np.exp(-self.rate * np.asarray(x))

    def cdf(self, x: np.ndarray) -> np.ndarray:
        return -np.expm1(-self.rate * np.maximum(x, 0.0))
