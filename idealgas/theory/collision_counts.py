"""Distribution of the number of collisions of a disc within a given time, in a dilute gas.

A disc collides at a rate that depends on its speed, and collisions change its speed. The number therefore does not
follow a Poisson distribution: Visco, van Wijland & Trizac, J. Phys. Chem. B 112, 5412 (2008) and Phys. Rev. E 77,
041117 (2008).
"""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

BASIS = 10
"""Number of Laguerre polynomials of the energy; with only 8 polynomials the variance differs by 4e-6."""


@cache
def _operators() -> tuple[np.ndarray, np.ndarray]:
    """Return the matrices (BASIS, BASIS) of the collision gain K and the collision rate ν, divided by the mean rate.

    Let s and w be the energies of the centre of mass and of the relative motion of two discs, divided by T, and θ the
    angle between the two velocities. Then m v²/2T is (s + w)/2 + √(sw) cos θ. A collision turns the relative velocity
    by χ, where |b|/σ = |cos(χ/2)| is distributed uniformly from 0 to 1, so that the mean of cos kχ is -1/(4k² - 1).
    """
    from scipy import special

    s, weight_s = special.roots_laguerre(BASIS)
    w, weight_w = special.roots_genlaguerre(BASIS, 0.5)
    weight = weight_s[:, None] * weight_w / weight_w.sum()
    angles = 2 * BASIS
    k = np.fft.fftfreq(angles, 1 / angles)
    turned = np.where(np.abs(k) < BASIS, -1 / (4 * k * k - 1), 0.0)
    cross = np.sqrt(s[:, None] * w)[..., None] * np.cos(2 * np.pi * np.arange(angles) / angles)
    energy = ((s[:, None] + w) / 2)[..., None] + cross
    modes = np.fft.fft([special.eval_laguerre(n, energy) for n in range(BASIS)]) / angles
    gain, loss = (
        np.einsum("mswk,nswk,sw,k->mn", modes, modes.conj(), weight, factor, optimize=True).real
        for factor in (turned, np.ones(angles))
    )
    return gain, loss


@dataclass(frozen=True)
class CollisionCountLaw:
    """Distribution of the number of collisions of a disc, with mean `mean`, in a gas of equal discs.

    To make the distribution continuous, a uniform deviate between -1/2 and 1/2 is added to the number.
    """

    mean: float

    @cached_property
    def probabilities(self) -> np.ndarray:
        """Probabilities of 0, 1, 2, … collisions, from the generating function ⟨1|exp(t(zK - ν))|1⟩ on |z| = 1."""
        from scipy import linalg

        gain, loss = _operators()
        most = 2 ** int(np.ceil(np.log2(self.mean + 15 * np.sqrt(self.mean) + 32)))
        z = np.exp(2j * np.pi * np.arange(most) / most)
        generating = linalg.expm(self.mean * (z[:, None, None] * gain - loss))[:, 0, 0]
        return np.maximum(np.fft.fft(generating).real / most, 0.0)

    @cached_property
    def cumulants(self) -> tuple[float, float]:
        """Second and third cumulants divided by the mean; both are 1 for a Poisson distribution."""
        n, mean = np.arange(len(self.probabilities)), self.mean
        second, third = (float(((n - mean) ** power) @ self.probabilities) / mean for power in (2, 3))
        return second, third

    def pdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability density at x, which is the probability of the integer nearest to x."""
        n = np.rint(x).astype(int)
        inside = (n >= 0) & (n < len(self.probabilities))
        return np.where(inside, self.probabilities[np.where(inside, n, 0)], 0.0)

    def cdf(self, x: np.ndarray) -> np.ndarray:
        """Return the probability of a value of at most x."""
        edges = np.arange(len(self.probabilities) + 1) - 0.5
        return np.interp(x, edges, np.append(0.0, np.cumsum(self.probabilities)))
