"""Theoretical profiles of density and temperature, for discs that are small compared with a strip."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from idealgas.columns import sides_across
from idealgas.log import Log
from idealgas.tallies.equilibrium import column_profiles, column_temperature, known_ensemble
from idealgas.theory import hard_discs
from idealgas.theory.ensemble import Composition, classes, ensemble_at
from idealgas.theory.values import Theory

UNIFORM = "uniform"
"""Name of the law for a uniform gas."""

LEAST = 1e-100
"""Density and temperature, relative to the bottom, at heights that no disc has enough energy to reach: nearly 0."""

POINTS = 64
"""Number of points in each strip over which the theoretical profiles are averaged."""

MOST_KINDS = 16
"""Largest number of kinds of discs in the theory of a column at fixed energy; its cost grows as their square."""

JUMP = 2.7
"""Temperature jump at a side with complete accommodation, over the temperature gradient, in mean free paths.

It was fitted to the temperatures in ten strips of boxes 2.8 to 23 mean free paths wide, with walls at temperatures of 1
and 2, or 1 and 4.
"""

JUMP_ERROR = 0.3
"""Root-mean-square error of the jump law, relative to the mean jump; measured values are 0.17 to 0.28."""

LEAST_INSIDE = 0.4
"""Smallest fraction of the temperature difference between the walls that lies in the gas, for the law to hold."""

ROUNDS, STEP = 200, 0.25
"""Number of iterations for the pressure and for the temperatures at the sides, and relaxation factor of the latter."""

GRID = 4097
"""Number of points in the tables of the density between the sides and of the equation of state."""


@dataclass(frozen=True)
class Expected:
    """Theoretical profiles of S species in K strips.

    Attributes:
        law: name of the law.
        dilute: whether the law holds only for dilute gases, at least for the temperature.
        density: (S, K), mean number density in each strip, 1/length².
        temperature: (S, K), mean temperature in each strip, energy.
        share: (S,), ratio of the mean m v²/2 of a disc, relative to a conserved motion of the whole gas, to the
            temperature (no unit).
        error: error of the temperatures, energy.
        layers: (2,), fraction by which layering at the walls may raise the density in the first and in the last strip,
            (1 - 1/Z) R/width. At φ = 0.1 and 0.5, with ten and twenty strips, 0.7 to 0.9 times this was measured.
    """

    law: str
    dilute: bool
    density: np.ndarray
    temperature: np.ndarray
    share: np.ndarray
    error: float
    layers: np.ndarray

    def of_density(self, s: int, k: int) -> Theory:
        """Return the density of species s in strip k; its error includes that of the common pressure."""
        density, cold = self.density[s], self.error / self.temperature[s]
        last = len(density) - 1
        low, high = self.layers
        layers = low if k == 0 else high if k == last else (low + high) / (last - 1)  # missing in inner strips
        error = math.hypot(cold[k], density @ cold / density.sum(), layers)
        return Theory(float(density[k]), float(density[k] * error), self.law)

    def of_temperature(self, s: int, k: int) -> Theory:
        """Return the mean m v²/2 of species s in strip k."""
        return self.of_spin(s, k).times(float(self.share[s]))

    def of_spin(self, s: int, k: int) -> Theory:
        """Return the mean I ω² of species s in strip k."""
        return Theory(float(self.temperature[s, k]), self.error, self.law)


def flow_axis(log: Log) -> int | None:
    """Return the axis along which gravity drives a flow, 0 for x or 1 for y; None if there is no flow."""
    falls = log.scene.properties.free_fall_axes
    return falls.index(True) if any(falls) else None


def natural_axis(log: Log) -> int:
    """Return the axis along which the profiles vary, 0 for x or 1 for y.

    It is the axis perpendicular to a flow, the axis of gravity, or the axis between two thermal sides at different
    temperatures; x if there are none of these.
    """
    if (along := flow_axis(log)) is not None:
        return 1 - along
    if log.gravity[1] != 0 or log.scene.properties.shear:
        return 1
    bottom, top = (log.scene.properties.emits[side] for side in sides_across(1))
    return int(bottom is not None and top is not None and bottom != top)


def expected_profile(log: Log, axis: int, edges: np.ndarray, start: float) -> Expected | None:
    """Return theoretical profiles in strips between edges (K + 1,) for a window from time `start`; None if unknown."""
    properties, discs = log.scene.properties, classes(log.discs)
    if (
        properties.shear
        or start < properties.last_wall_removed_at
        or not properties.fixed_walls
        or log.gravity[1 - axis]
    ):
        return None
    reach = discs.radius * (not log.periodic[axis])  # distance of the centres from the sides
    inside = np.clip(edges, reach[:, None], log.box[axis] - reach[:, None])
    size = np.diff(inside)
    places = inside[:, :-1, None] + size[:, :, None] * (np.arange(POINTS) + 0.5) / POINTS
    curve = _curve(log, axis, places, discs)
    if curve is None:
        return None
    law, weight, temperature, error = curve
    parts = weight.mean(axis=2) * size
    number = discs.number[:, None] * parts / parts.sum(axis=1, keepdims=True)
    strips = np.diff(edges) * log.box[1 - axis]
    mean_temperature = (weight * temperature).mean(axis=2) / weight.mean(axis=2)
    share = ensemble_at(log.scene, log.discs, 1.0, math.inf).of_species
    layers = np.zeros(2)
    if not log.periodic[axis] and not log.gravity[axis] and properties.interacting:
        phi = math.pi * discs.radius**2 @ (number / strips)[:, [0, -1]]
        z = hard_discs.compressibility_factor(np.minimum(phi, hard_discs.HIGHEST))
        layers = (1 - 1 / z) * min(float(discs.radius.max() / np.diff(edges).min()), 1.0)
    if len(discs.members) < len(number):  # average over the kinds of a species
        mean_temperature = discs.members @ (number * mean_temperature) / (discs.members @ number)
    return Expected(law, law != UNIFORM, discs.members @ (number / strips), mean_temperature, share, error, layers)


Curve = tuple[str, np.ndarray, np.ndarray, float]
"""Name of the law, relative density and temperature at coordinates (S, K, P), and error of the temperatures."""


def _curve(log: Log, axis: int, places: np.ndarray, discs: Composition) -> Curve | None:
    """Return the law and its density and temperature at coordinates `places` (S, K, P); None if there is no theory."""
    ones = np.ones_like(places)
    properties = log.scene.properties
    low, high = (properties.emits[side] for side in sides_across(axis))
    if len(properties.temperatures) == 2 and low is not None and high is not None:
        return None if low == high else _conduction(log, axis, places)
    if log.gravity[axis]:
        if (t := column_temperature(log, axis)) is None:
            return None
        if properties.isolated:
            few = len(discs.mass) <= MOST_KINDS
            return _fixed_energy(log, axis, places, discs, t) if few else None
        weight = np.exp(discs.mass[:, None, None] * log.gravity[axis] * (places - log.box[axis] / 2) / t)
        return f"barometric: n ~ exp(-m g h/T), T = {t:.6g} at all heights", weight, t * ones, 0.0
    equilibrium = known_ensemble(log)
    if equilibrium is None:
        return None
    return UNIFORM, ones, equilibrium.temperature * ones, 0.0


def _fixed_energy(log: Log, axis: int, places: np.ndarray, discs: Composition, mean: float) -> Curve:
    """Return the barometric law at fixed energy: the higher a disc is, the less kinetic energy remains for all discs.

    mean: temperature of the whole column, averaged over the discs, energy.
    """
    low = places if log.gravity[axis] < 0 else log.box[axis] - places
    profiles = column_profiles(log, axis)
    above = list(zip(low - discs.radius[:, None, None], profiles, strict=True))
    weight = np.stack([np.interp(h, profile.above, profile.density, right=0.0) for h, profile in above])
    temperature = np.stack([np.interp(h, profile.above, profile.temperature) for h, profile in above])
    warmest = profiles[0].temperature[0]
    law = f"barometric at fixed energy, T = {mean:.6g} on average over the discs"
    return law, np.maximum(weight, LEAST), np.maximum(temperature, LEAST * warmest), 0.0


def conduction(log: Log, axis: int) -> "Conduction | None":
    """Return the temperatures of the gas at two thermal sides across an axis.

    The result is None unless the discs are equal and have no spin, and these sides are the only source of heat.
    """
    properties, gas = log.scene.properties, log.discs
    low, high = (properties.emits[side] for side in sides_across(axis))
    has_other_heat = properties.bath is not None or any(
        properties.emits[side] is not None for side in sides_across(1 - axis)
    )
    alike = properties.straight_flight and properties.collisions_conserve_energy and not properties.spins
    alike &= properties.interacting and len(gas.species_names) == 1 and not gas.unlike
    if low is None or high is None or has_other_heat or not alike:
        return None
    return conduct(low, high, log.box[axis], len(gas) / gas.area, 2 * float(gas.radius[0]))


def _conduction(log: Log, axis: int, places: np.ndarray) -> Curve | None:
    """Return Fourier's law between two thermal sides across an axis; None if there is no theory."""
    gas, ends = log.discs, conduction(log, axis)
    if ends is None:
        return None

    def temperature(place: np.ndarray) -> np.ndarray:
        power = ends.low**1.5 + (ends.high**1.5 - ends.low**1.5) * place / log.box[axis]
        return np.asarray(power ** (2 / 3))

    radius, size = float(gas.radius[0]), log.box[axis]
    grid = np.linspace(radius, size - radius, GRID)
    mean_fraction = gas.packing_fraction * size / (size - 2 * radius)
    fraction = _equal_pressure(temperature(grid), mean_fraction)
    if fraction is None:
        return None
    beside = f"from {ends.low:.6g} to {ends.high:.6g} beside the walls"
    law = f"T^(3/2) in a straight line (Fourier) and the same pressure n T Z, {beside}"
    return law, np.interp(places, grid, fraction), temperature(places), ends.error


def _equal_pressure(temperature: np.ndarray, mean_fraction: float) -> np.ndarray | None:
    """Return the packing fractions of hard discs at temperatures (n,) for which the pressure n T Z is the same.

    The result is None if a packing fraction lies beyond the fluid.
    """
    fraction = np.linspace(0.0, hard_discs.HIGHEST, GRID)
    pressure = fraction * hard_discs.compressibility_factor(fraction)  # over T, in units of 1/πR²
    common = mean_fraction * temperature.mean()
    for _ in range(ROUNDS):
        candidate = np.interp(common / temperature, pressure, fraction)
        common *= mean_fraction / candidate.mean()
    return candidate if candidate.max() < hard_discs.HIGHEST else None


class Conduction(NamedTuple):
    """Temperatures of the gas at the lower and at the upper side, and the error of temperatures, energy."""

    low: float
    high: float
    error: float


def conduct(low: float, high: float, size: float, density: float, diameter: float) -> Conduction | None:
    """Return the temperatures of a gas at two sides with temperatures low and high; None if the jumps are too large.

    T^(3/2) is linear from side to side, because the conductivity is proportional to √T, and nT is the same everywhere.
    The gas at a side does not have the temperature of the side, because half of the discs there arrive from inside the
    gas: T differs by the gradient times JUMP mean free paths. Source: Maxwell, Phil. Trans. 170, 231 (1879).

    Args:
        low: temperature of the lower side, energy.
        high: temperature of the upper side, energy.
        size: distance between the sides, length.
        density: mean number density, 1/length².
        diameter: diameter of a disc, length.
    """
    ratio = high / low
    a, b = 1.0, ratio  # in units of the temperature of the lower side
    for _ in range(ROUNDS):
        if (b - a) / (ratio - 1) < LEAST_INSIDE / 2:
            return None
        pressure = density * (a + math.sqrt(a * b) + b) / 3  # density over the mean of 1/T
        gradient = (b**1.5 - a**1.5) / size  # of T^(3/2)
        jump = JUMP * hard_discs.mean_free_path(diameter, pressure, 0.0) * 2 / 3 * gradient
        a += STEP * (1.0 + jump * math.sqrt(a) - a)
        b += STEP * (ratio - jump * math.sqrt(b) - b)
    if (b - a) / (ratio - 1) < LEAST_INSIDE:
        return None
    return Conduction(low * a, low * b, JUMP_ERROR * low * (abs(a - 1.0) + abs(b - ratio)) / 2)
