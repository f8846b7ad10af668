"""Radii and masses of the discs of a species, which are equal or follow a distribution.

The radii of N discs are the quantiles (k + 1/2)/N of their distribution, for k = 0 to N - 1. The gas therefore has the
same discs for every seed, and its packing fraction, mean radius and polydispersity agree with the values of the
distribution up to terms of order 1/N².
"""

import math
from functools import lru_cache
from statistics import NormalDist
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from idealgas.toml.table import NotNegative, Positive, Table

Pair = Annotated[tuple[Positive, Positive], Field(strict=False)]


class Uniform(Table):
    """`{ uniform = [a, b] }`: radii distributed uniformly from a to b."""

    uniform: Pair = Field(description="[smallest, largest], length")

    def radii(self, count: int) -> np.ndarray:
        """Return the radii (count,) in increasing order, length."""
        low, high = self.uniform
        return low + (high - low) * _shares(count)


class Normal(Table):
    """`{ normal = [mean, s.d.], least = a, most = b }`: normally distributed radii, truncated at a and b."""

    normal: Pair = Field(description="[mean, s.d.], length")
    least: NotNegative = Field(default=0.0, description="smallest radius, length")
    most: Positive | None = Field(default=None, description="largest radius, length; if absent, unlimited")

    def radii(self, count: int) -> np.ndarray:
        """Return the radii (count,) in increasing order, length."""
        law, (low, high) = NormalDist(*self.normal), self.shares
        share = low + (high - low) * _shares(count)
        return np.clip([law.inv_cdf(p) for p in share.tolist()], self.least, self.most)

    @property
    def shares(self) -> tuple[float, float]:
        """Cumulative probabilities of the untruncated distribution at the smallest and at the largest radius."""
        law = NormalDist(*self.normal)
        return law.cdf(self.least), 1.0 if self.most is None else law.cdf(self.most)


class Values(Table):
    """`{ values = [r, ...] }`: a list of radii for the discs in order; a shorter list is repeated."""

    values: Annotated[tuple[Positive, ...], Field(strict=False)] = Field(description="[radius, ...], length")

    def radii(self, count: int) -> np.ndarray:
        """Return the radii (count,) in the order of the discs, length."""
        return np.resize(self.values, count)


class Density(Table):
    """`{ density = d }`: masses proportional to the areas of the discs."""

    density: Positive = Field(description="mass per area, > 0")


LEAST_SHARE = 1e-6
"""Smallest allowed fraction of a normal distribution between the smallest and the largest radius."""


class Size(NamedTuple):
    """Radius (length), mass, and number of discs with this radius and mass."""

    radius: float
    mass: float
    number: int


def _shares(count: int) -> np.ndarray:
    return (np.arange(count) + 0.5) / count


def mass_of(mass: float | Density, radius: np.ndarray) -> np.ndarray:
    """Return the masses (n,) of discs.

    Args:
        mass: value of the key `mass` of their species.
        radius: (n,), length.
    """
    return mass.density * math.pi * radius * radius if isinstance(mass, Density) else np.full(len(radius), mass)


@lru_cache(maxsize=32)
def sizes_of(radius: float | Uniform | Normal | Values, mass: float | Density, count: int) -> tuple[Size, ...]:
    """Return the sizes of the discs of a species: one entry if the radius is a number, else one entry per disc."""
    radii = np.array([radius]) if isinstance(radius, float) else radius.radii(count)
    masses, number = mass_of(mass, radii).tolist(), count if isinstance(radius, float) else 1
    return tuple(Size(r, m, number) for r, m in zip(radii.tolist(), masses, strict=True))


def wrong_radius(radius: float | Uniform | Normal | Values) -> tuple[str, str, str] | None:
    """Return what is wrong with the radius of a species, its value, and what is allowed; None if it is valid."""
    match radius:
        case Uniform(uniform=(low, high)) if low > high:
            return "largest radius below the smallest", str([low, high]), "[smallest, largest]"
        case Normal() if radius.shares[1] - radius.shares[0] < LEAST_SHARE:
            interval = f"{radius.least} to {radius.most or 'infinity'}"
            return "hardly any radii between least and most", interval, f">= {LEAST_SHARE:g} of the distribution"
        case Values(values=()):
            return "no radii", "[]", "at least one"
    return None
