"""Profiles of density and temperature by theory, for gases of discs that are small compared with a strip."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from idealgas.analysis.core.ensemble import column_profiles, column_temperature, known_ensemble
from idealgas.analysis.theory import hard_discs
from idealgas.analysis.theory.ensemble import Composition, classes, ensemble_at
from idealgas.analysis.theory.values import Theory
from idealgas.columns import sides_across
from idealgas.log import Log

UNIFORM = "uniform"
"""Name of the law of a gas that is the same everywhere."""

LEAST = 1e-100
"""Density and temperature where the energy lifts no disc, relative to those at the lowest place: as good as 0."""

POINTS = 64
"""Number of points in a strip over which the theory is averaged."""

MOST_KINDS = 16
"""Kinds of discs up to which there is a theory of a column of fixed energy: its time grows as their square."""

JUMP = 2.7
"""Length over which the gradient extends beyond a side that takes up discs completely, in mean free paths.

Temperatures in ten strips were measured with boxes 2.8 to 23 mean free paths wide and walls of 1 and 2, or 1 and 4.
"""

JUMP_ERROR = 0.3
"""Root mean square of their deviations from this law, relative to the mean jump; 0.17 to 0.28 were found."""

LEAST_INSIDE = 0.4
"""Least part of the difference of temperatures that is left in the gas; in narrower boxes the law is another."""

ROUNDS, STEP = 200, 0.25
"""Number of iterations for the pressure and for the temperatures beside the sides, and step of the latter."""

GRID = 4097
"""Number of points of the tables of the density between two sides and of the equation of state."""


@dataclass(frozen=True)
class Expected:
    """Profiles by theory for S species and K strips.

    Attributes:
        law: name of the law.
        dilute: whether it holds in dilute gases only, at least for the temperature.
        density: (S, K), mean number density of each strip, 1/length².
        temperature: (S, K), mean temperature of each strip, energy.
        share: (S,), mean m v²/2 of a disc over the temperature, without a conserved motion of the whole gas; no unit.
        error: of temperatures, energy.
        layers: (2,), part by which layers at walls may raise the density of the first and the last strip,
            (1 - 1/Z) R/width: at φ = 0.1 and 0.5, by ten and twenty strips, 0.7 to 0.9 times that was found.
    """

    law: str
    dilute: bool
    density: np.ndarray
    temperature: np.ndarray
    share: np.ndarray
    error: float
    layers: np.ndarray

    def of_density(self, s: int, k: int) -> Theory:
        """Density of species s in strip k; errors of all temperatures change the pressure, which all strips have."""
        density, cold = self.density[s], self.error / self.temperature[s]
        last = len(density) - 1
        low, high = self.layers
        layers = low if k == 0 else high if k == last else (low + high) / (last - 1)  # the others have that much less
        error = math.hypot(cold[k], density @ cold / density.sum(), layers)
        return Theory(float(density[k]), float(density[k] * error), self.law)

    def of_temperature(self, s: int, k: int) -> Theory:
        """Mean m v²/2 of species s in strip k."""
        return self.of_spin(s, k).times(float(self.share[s]))

    def of_spin(self, s: int, k: int) -> Theory:
        """Mean I ω² of species s in strip k."""
        return Theory(float(self.temperature[s, k]), self.error, self.law)


def flow_axis(log: Log) -> int | None:
    """Axis along which gravity drives a flow, 0 for x or 1 for y; None without one."""
    falls = log.scene.properties.free_fall_axes
    return falls.index(True) if any(falls) else None


def natural_axis(log: Log) -> int:
    """Axis (0 for x, 1 for y) across a flow, of gravity, or of two thermal sides of different temperatures; else x."""
    if (along := flow_axis(log)) is not None:
        return 1 - along
    if log.gravity[1] != 0 or log.scene.properties.shear:
        return 1
    bottom, top = (log.scene.properties.emits[side] for side in sides_across(1))
    return int(bottom is not None and top is not None and bottom != top)


def expected_profile(log: Log, axis: int, edges: np.ndarray, start: float) -> Expected | None:
    """Profiles by theory in the strips between edges (K + 1,), for a gas from time `start` on; None if unknown."""
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
    found = _curve(log, axis, places, discs)
    if found is None:
        return None
    law, weight, temperature, error = found
    parts = weight.mean(axis=2) * size
    number = discs.number[:, None] * parts / parts.sum(axis=1, keepdims=True)
    strips = np.diff(edges) * log.box[1 - axis]
    mean_temperature = (weight * temperature).mean(axis=2) / weight.mean(axis=2)
    share = ensemble_at(log.scene, log.discs, 1.0, math.inf).of_species
    layers = np.zeros(2)
    if not log.periodic[axis] and not log.gravity[axis]:
        phi = math.pi * discs.radius**2 @ (number / strips)[:, [0, -1]]
        z = hard_discs.compressibility_factor(np.minimum(phi, hard_discs.HIGHEST))
        layers = (1 - 1 / z) * min(float(discs.radius.max() / np.diff(edges).min()), 1.0)
    if len(discs.members) < len(number):  # means over the kinds of a species
        mean_temperature = discs.members @ (number * mean_temperature) / (discs.members @ number)
    return Expected(law, law != UNIFORM, discs.members @ (number / strips), mean_temperature, share, error, layers)


Curve = tuple[str, np.ndarray, np.ndarray, float]


def _curve(log: Log, axis: int, places: np.ndarray, discs: Composition) -> Curve | None:
    """Name of the law, relative density and temperature at the coordinates `places` (S, K, P), and the error of T.

    None if unknown.
    """
    one = np.ones_like(places)
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
        return f"barometric: n ~ exp(-m g h/T), T = {t:.6g} at all heights", weight, t * one, 0.0
    equilibrium = known_ensemble(log)
    if equilibrium is None:
        return None
    return UNIFORM, one, equilibrium.temperature * one, 0.0


def _fixed_energy(log: Log, axis: int, places: np.ndarray, discs: Composition, mean: float) -> Curve:
    """Barometric law of a fixed energy, which leaves less to the discs the higher one of them is.

    mean: temperature of the whole column, energy.
    """
    low = places if log.gravity[axis] < 0 else log.box[axis] - places
    profiles = column_profiles(log, axis)
    above = list(zip(low - discs.radius[:, None, None], profiles, strict=True))
    weight = np.stack([np.interp(h, found.above, found.density, right=0.0) for h, found in above])
    temperature = np.stack([np.interp(h, found.above, found.temperature) for h, found in above])
    warmest = profiles[0].temperature[0]
    law = f"barometric at fixed energy, T = {mean:.6g} on average over the discs"
    return law, np.maximum(weight, LEAST), np.maximum(temperature, LEAST * warmest), 0.0


def conduction(log: Log, axis: int) -> "Conduction | None":
    """Temperatures beside two thermal sides across an axis, for equal discs without spin and no other heat."""
    properties, gas = log.scene.properties, log.discs
    low, high = (properties.emits[side] for side in sides_across(axis))
    others = properties.bath is not None or any(properties.emits[side] is not None for side in sides_across(1 - axis))
    alike = properties.straight_flight and properties.collisions_conserve_energy and not properties.spins
    if low is None or high is None or others or not alike or len(gas.species_names) > 1 or gas.unlike:
        return None
    return conduct(low, high, log.box[axis], len(gas) / gas.area, 2 * float(gas.radius[0]))


def _conduction(log: Log, axis: int, places: np.ndarray) -> Curve | None:
    """Fourier's law between two thermal sides across an axis."""
    gas, found = log.discs, conduction(log, axis)
    if found is None:
        return None

    def temperature(place: np.ndarray) -> np.ndarray:
        power = found.low**1.5 + (found.high**1.5 - found.low**1.5) * place / log.box[axis]
        return np.asarray(power ** (2 / 3))

    radius, size = float(gas.radius[0]), log.box[axis]
    grid = np.linspace(radius, size - radius, GRID)
    mean_fraction = gas.packing_fraction * size / (size - 2 * radius)
    fraction = _equal_pressure(temperature(grid), mean_fraction)
    if fraction is None:
        return None
    beside = f"from {found.low:.6g} to {found.high:.6g} beside the walls"
    law = f"T^(3/2) in a straight line (Fourier) and the same pressure n T Z, {beside}"
    return law, np.interp(places, grid, fraction), temperature(places), found.error


def _equal_pressure(temperature: np.ndarray, mean_fraction: float) -> np.ndarray | None:
    """Packing fractions of hard discs at temperatures (n,) that have one pressure n T Z; None beyond the fluid."""
    fraction = np.linspace(0.0, hard_discs.HIGHEST, GRID)
    pressure = fraction * hard_discs.compressibility_factor(fraction)  # over T, in units of 1/πR²
    common = mean_fraction * temperature.mean()
    for _ in range(ROUNDS):
        found = np.interp(common / temperature, pressure, fraction)
        common *= mean_fraction / found.mean()
    return found if found.max() < hard_discs.HIGHEST else None


class Conduction(NamedTuple):
    """Temperatures of the gas at the lower and at the higher side, and the error of temperatures, energy."""

    low: float
    high: float
    error: float


def conduct(low: float, high: float, size: float, density: float, diameter: float) -> Conduction | None:
    """Temperatures of a gas between sides of temperatures low and high, energy; None where the jumps are too large.

    T^(3/2) changes evenly from side to side, as the conductivity is proportional to √T, and nT is the same everywhere.
    Where no disc comes from behind, the gas next to a thermal side is not at its temperature: T differs from it by the
    gradient times JUMP mean free paths. Source: Maxwell, Phil. Trans. 170, 231 (1879).

    Args:
        low: temperature of the lower side, energy.
        high: temperature of the higher side, energy.
        size: distance of the sides, length.
        density: mean number density, 1/length².
        diameter: of a disc, length.
    """
    ratio = high / low
    a, b = 1.0, ratio  # in units of the lower side's
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
