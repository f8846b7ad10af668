"""Probability distributions of a gas in equilibrium, each with `pdf`, `cdf` and `mean`.

The velocity distributions take `temperature`, the mean kinetic energy T of a disc (two degrees of freedom, k_B = 1),
and `dof`, the number D of velocity degrees of freedom of a gas at fixed total energy. For D = ∞ they are
Maxwell-Boltzmann distributions. Otherwise the kinetic energy of a disc, divided by its largest possible value TD/2,
follows the distribution Beta(1, D/2 - 1), which is a projection of the uniform distribution on a sphere.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Protocol

import numpy as np

from idealgas.theory.hard_discs import mean_speed


class Law(Protocol):
    """Continuous probability distribution of a quantity."""

    @property
    def mean(self) -> float:
        """Mean of the quantity, in its unit."""

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability density at x in 1/unit of the quantity, with the shape of x."""

    def cdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability of a value of at most x; same shape as x."""


@dataclass(frozen=True)
class MeanLaw:
    """Mixture of several distributions of a quantity: each value follows one of them, chosen at random.

    Attributes:
        parts: the distributions.
        weights: relative probability of each distribution; None if all are equal.
    """

    parts: tuple[Law, ...]
    weights: tuple[float, ...] | None = None

    @property
    def mean(self) -> float:
        """Mean of the quantity, in its unit."""
        return float(np.average([part.mean for part in self.parts], weights=self.weights))

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability density at the values x."""
        return np.average([part.pdf(x) for part in self.parts], axis=0, weights=self.weights)

    def cdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability of a value of at most x."""
        return np.average([part.cdf(x) for part in self.parts], axis=0, weights=self.weights)


@dataclass(frozen=True)
class EnergyLaw:
    """Distribution of the kinetic energy of a disc: exponential, or its counterpart at fixed total energy.

    At fixed total energy P(> e) = (1 - 2e/TD)^(D/2 - 1).

    Attributes:
        temperature: temperature T, energy.
        dof: degrees of freedom D.
    """

    temperature: float
    dof: float = math.inf

    @property
    def mean(self) -> float:
        """Mean kinetic energy T, energy."""
        return self.temperature

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability density of the energies x, 1/energy."""
        share = np.maximum(x, 0.0) / self.temperature
        if math.isinf(self.dof):
            return np.where(np.asarray(x) < 0, 0.0, np.exp(-share) / self.temperature)
        half = self.dof / 2
        free = 1 - share / half
        possible = (np.asarray(x) >= 0) & (free > 0)
        density = (half - 1) / half * np.where(possible, free, 1.0) ** (half - 2) / self.temperature
        return np.where(possible, density, 0.0)

    def cdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability of a kinetic energy of at most x."""
        share = np.maximum(x, 0.0) / self.temperature
        if math.isinf(self.dof):
            return -np.expm1(-share)
        half = self.dof / 2
        return 1 - np.maximum(1 - share / half, 0.0) ** (half - 1)


@dataclass(frozen=True)
class SpeedLaw:
    """Distribution of the speed of a disc: f(v) = (m v/T) exp(-m v²/2T), or its counterpart at fixed total energy.

    Attributes:
        temperature: temperature T, energy.
        mass: mass m of the disc.
        dof: degrees of freedom D.
    """

    temperature: float
    mass: float
    dof: float = math.inf

    @property
    def mean(self) -> float:
        """Mean speed, length/time."""
        return mean_speed(self.temperature, self.mass, self.dof)

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability density of the speeds x, time/length."""
        speed = np.maximum(x, 0.0)
        return EnergyLaw(self.temperature, self.dof).pdf(self.mass * speed**2 / 2) * self.mass * speed

    def cdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability of a speed of at most x."""
        return EnergyLaw(self.temperature, self.dof).cdf(self.mass * np.maximum(x, 0.0) ** 2 / 2)


@dataclass(frozen=True)
class ComponentLaw:
    """Distribution of a velocity component of a disc: normal with mean 0 and variance T/m.

    At fixed total energy its density is proportional to (1 - m v²/TD)^((D - 3)/2).

    Attributes:
        temperature: temperature T, energy.
        mass: mass m of the disc.
        dof: degrees of freedom D.
    """

    temperature: float
    mass: float
    dof: float = math.inf

    @property
    def mean(self) -> float:
        """Mean velocity component: 0."""
        return 0.0

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability density of the velocity components x, time/length."""
        from scipy import special

        z = np.asarray(x) * math.sqrt(self.mass / self.temperature)
        if math.isinf(self.dof):
            return np.exp(-(z**2) / 2) * math.sqrt(self.mass / (2 * math.pi * self.temperature))
        norm = math.sqrt(self.mass / (self.temperature * self.dof)) / special.beta(0.5, (self.dof - 1) / 2)
        return norm * np.maximum(1 - z**2 / self.dof, 0.0) ** ((self.dof - 3) / 2)  # D > 3

    def cdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability of a velocity component of at most x."""
        from scipy import special

        z = np.asarray(x) * math.sqrt(self.mass / self.temperature)
        if math.isinf(self.dof):
            return special.ndtr(z)
        share = np.minimum(z**2 / self.dof, 1.0)
        return 0.5 + 0.5 * np.sign(z) * special.betainc(0.5, (self.dof - 1) / 2, share)


def mean_relative_speed_at(speed: np.ndarray, temperature: float, mass: float) -> np.ndarray:
    """Return the mean relative speed ⟨|v - u|⟩ of a disc of speed v and discs with thermal velocities u, length/time.

    It is √(πT/2m) e^(-x/2) [(1 + x) I₀(x/2) + x I₁(x/2)] with x = m v²/2T, the mean of a Rice distribution.

    Args:
        speed: speeds v of the disc, length/time.
        temperature: temperature T, energy.
        mass: mass m of the discs with thermal velocities.
    """
    from scipy import special

    x = mass * np.asarray(speed) ** 2 / (2 * temperature)
    bessel = (1 + x) * special.i0e(x / 2) + x * special.i1e(x / 2)
    return mean_speed(temperature, mass) * bessel


@cache
def _quadrature() -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes v √(m/2T) and weights of Gauss-Legendre quadrature from 0 to 7; exp(-7²) is negligible."""
    y, weight = np.polynomial.legendre.leggauss(120)
    return 3.5 * (y + 1), 3.5 * weight


@dataclass(frozen=True)
class _FlightLaw(ABC):
    """Distribution of the free flights of a disc that collides with species j at the mean rate `rates[j]`.

    A disc of speed v collides at the rate ν(v) = Σ_j rate_j ⟨|v - u_j|⟩/⟨|w - u_j|⟩, where u_j and w are thermal
    velocities. After a collision, its speed has the density f(v) ν(v)/Γ, because by time reversal this is the density
    before a collision. Collisions are assumed to be independent, which is exact in the dilute limit (Boltzmann). In
    denser gases two discs may soon collide again.

    Attributes:
        temperature: temperature T, energy.
        mass: mass of the disc.
        masses: masses of the discs of each species.
        rates: collision rates of the disc with each species, 1/time.
    """

    temperature: float
    mass: float
    masses: tuple[float, ...]
    rates: tuple[float, ...]

    @cached_property
    def _nodes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Speed, probability weight of a flight, and collision rate ν at the nodes of a quadrature over speeds."""
        y, weight = _quadrature()
        speed = y * math.sqrt(2 * self.temperature / self.mass)
        rate = np.zeros_like(speed)
        for partner_mass, mean_rate in zip(self.masses, self.rates, strict=True):
            mean = mean_speed(self.temperature, self.mass * partner_mass / (self.mass + partner_mass))
            rate += mean_rate * mean_relative_speed_at(speed, self.temperature, partner_mass) / mean
        return speed, weight * 2 * y * np.exp(-(y**2)) * rate / sum(self.rates), rate

    @abstractmethod
    def _decay(self) -> np.ndarray:
        """Return the decay rate of the survival probability of a flight at each node, 1/time or 1/length."""

    @property
    def mean(self) -> float:
        """Mean free time (time) or mean free path (length)."""
        return float((self._nodes[1] / self._decay()).sum())

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability density of the free times or path lengths x, 1/time or 1/length."""
        decay = self._decay()
        return np.exp(-np.multiply.outer(np.asarray(x, float), decay)) @ (self._nodes[1] * decay)

    def cdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability of a free time or path length of at most x."""
        return 1 - np.exp(-np.multiply.outer(np.maximum(x, 0.0), self._decay())) @ self._nodes[1]


class FreeTimeLaw(_FlightLaw):
    """Distribution of the time between two collisions of a disc with other discs; its mean is 1/Γ."""

    def _decay(self) -> np.ndarray:
        return self._nodes[2]


class FreePathLaw(_FlightLaw):
    """Distribution of the path length between two collisions of a disc with other discs; its mean is ⟨v⟩/Γ."""

    def _decay(self) -> np.ndarray:
        return self._nodes[2] / self._nodes[0]


@dataclass(frozen=True)
class UniformLaw:
    """Uniform distribution from 0 to 1."""

    mean = 0.5

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability density at the values x."""
        return np.where((np.asarray(x) >= 0) & (np.asarray(x) <= 1), 1.0, 0.0)

    def cdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability of a value of at most x."""
        return np.clip(x, 0.0, 1.0)


@dataclass(frozen=True)
class WaitingTimeLaw:
    """Distribution of the time between events of the whole gas: exponential if many discs collide independently.

    rate: events per time, 1/time.
    """

    rate: float

    @property
    def mean(self) -> float:
        """Mean waiting time 1/rate, time."""
        return 1 / self.rate

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability density of the waiting times x, 1/time."""
        return self.rate * np.exp(-self.rate * np.asarray(x))

    def cdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability of a waiting time of at most x."""
        return -np.expm1(-self.rate * np.maximum(x, 0.0))
