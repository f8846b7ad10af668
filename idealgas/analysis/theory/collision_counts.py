"""Distribution of the number of collisions of a disc in a time, in a dilute gas.

A disc collides at a rate that depends on its speed, and its speed changes in collisions: the number is not that of a
Poisson process. Visco, van Wijland & Trizac, J. Phys. Chem. B 112, 5412 (2008) and Phys. Rev. E 77, 041117 (2008).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

BASIS = 10
"""Number of Laguerre polynomials of the energy; with 8 the variance of equal discs differs by 4e-6."""


@dataclass(frozen=True)
class CollisionCountLaw:
    """Number of collisions in `time` of a disc of `mass` that collides with species j at the mean rate `rates[j]`.

    As a continuous distribution: that of the number plus an even deviate from -1/2 to 1/2. mass: of the disc, mass.
    masses: of the discs of each species, mass. rates: collision rates of the disc with each species, 1/time.
    """

    mass: float
    masses: tuple[float, ...]
    rates: tuple[float, ...]
    time: float

    @cached_property
    def probabilities(self) -> np.ndarray:
        """Probabilities of 0, 1, 2, … collisions, from the generating function ⟨1|exp(t(zK - ν))|1⟩ on |z| = 1."""
        from scipy import linalg

        gain, loss = self._operators()
        expected = sum(self.rates) * self.time
        most = 2 ** int(np.ceil(np.log2(expected + 15 * np.sqrt(expected) + 32)))
        z = np.exp(2j * np.pi * np.arange(most) / most)
        generating = linalg.expm(self.time * (z[:, None, None] * gain - loss))[:, 0, 0]
        return np.maximum(np.fft.fft(generating).real / most, 0.0)

    def _operators(self) -> tuple[np.ndarray, np.ndarray]:
        """Matrices (BASIS, BASIS) of K, by which discs come into a state, and of their collision rate ν, 1/time.

        With a = m/(m + m_j), s and w the energies of the centre of mass and of the relative motion over T, and θ the
        angle between both velocities, m v²/2T is a s + (1 - a) w + 2√(a(1 - a)sw) cos θ. A collision turns θ by χ, with
        |b|/σ = |cos(χ/2)| even from 0 to 1, so that the mean of cos kχ is -1/(4k² - 1).
        """
        from scipy import special

        gain, loss = np.zeros((2, BASIS, BASIS))
        s, weight_s = special.roots_laguerre(BASIS)
        w, weight_w = special.roots_genlaguerre(BASIS, 0.5)
        weight = weight_s[:, None] * weight_w / weight_w.sum()
        angles = 2 * BASIS
        k = np.fft.fftfreq(angles, 1 / angles)
        turned = np.where(np.abs(k) < BASIS, -1 / (4 * k * k - 1), 0.0)
        for other, rate in zip(self.masses, self.rates, strict=True):
            a = self.mass / (self.mass + other)
            cross = (
                2 * np.sqrt(a * (1 - a) * s[:, None] * w)[..., None] * np.cos(2 * np.pi * np.arange(angles) / angles)
            )
            energy = (a * s[:, None] + (1 - a) * w)[..., None] + cross
            modes = np.fft.fft([special.eval_laguerre(n, energy) for n in range(BASIS)]) / angles
            for found, factor in ((loss, np.ones(angles)), (gain, turned)):
                found += rate * np.einsum("mswk,nswk,sw,k->mn", modes, modes.conj(), weight, factor, optimize=True).real
        return gain, loss

    @property
    def mean(self) -> float:
        """Mean number of collisions."""
        return sum(self.rates) * self.time

    @cached_property
    def cumulants(self) -> tuple[float, float]:
        """Second and third cumulant over the mean; 1 for a Poisson process."""
        n, mean = np.arange(len(self.probabilities)), self.mean
        second, third = (float(((n - mean) ** power) @ self.probabilities) / mean for power in (2, 3))
        return second, third

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Probability of the nearest whole number."""
        n = np.rint(x).astype(int)
        inside = (n >= 0) & (n < len(self.probabilities))
        return np.where(inside, self.probabilities[np.where(inside, n, 0)], 0.0)

    def cdf(self, x: np.ndarray) -> np.ndarray:
        """Probability of a value of at most x."""
        edges = np.arange(len(self.probabilities) + 1) - 0.5
        return np.interp(x, edges, np.append(0.0, np.cumsum(self.probabilities)))
