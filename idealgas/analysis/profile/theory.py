"""Profiles of density and temperature by theory, for dilute gases of discs that are small compared with a strip."""

from dataclasses import dataclass

import numpy as np

from idealgas.analysis.core.composition import Composition, composition
from idealgas.analysis.core.equilibrium import column_temperature, known_ensemble
from idealgas.log import Log
from idealgas.sides import sides_across

UNIFORM = "uniform"
"""Name of the law of a gas that is the same everywhere."""

POINTS = 64
"""Number of points in a strip over which the theory is averaged."""


@dataclass(frozen=True)
class Expected:
    """Profiles by theory for S species and K strips.

    law: name of the law. dilute: whether it holds in dilute gases only. density: (S, K), mean number density of each
    strip, 1/length². temperature: (S, K), mean temperature of each degree of freedom, energy.
    """

    law: str
    dilute: bool
    density: np.ndarray
    temperature: np.ndarray


def natural_axis(log: Log) -> int:
    """Axis (0 for x, 1 for y) of gravity, or of two thermal sides of different temperatures; else x."""
    if log.gravity[1] != 0:
        return 1
    bottom, top = (log.scene.properties.emits[side] for side in sides_across(1))
    return int(bottom is not None and top is not None and bottom != top)


def expected_profile(log: Log, axis: int, edges: np.ndarray, start: float) -> Expected | None:
    """Profiles by theory in the strips between edges (K + 1,), for a gas from time `start` on; None if unknown."""
    properties, discs = log.scene.properties, composition(log.discs)
    if start < properties.clear_from or not properties.fixed_walls or log.gravity[1 - axis]:
        return None
    reach = (
        np.zeros_like(discs.radius) if log.periodic[axis] else discs.radius
    )  # distance of the centres from the sides
    inside = np.clip(edges, reach[:, None], log.box[axis] - reach[:, None])
    size = np.diff(inside)
    places = inside[:, :-1, None] + size[:, :, None] * (np.arange(POINTS) + 0.5) / POINTS
    found = _course(log, axis, places, discs)
    if found is None:
        return None
    law, weight, temperature = found
    parts = weight.mean(axis=2) * size
    number = discs.number[:, None] * parts / parts.sum(axis=1, keepdims=True)
    strips = np.diff(edges) * log.box[1 - axis]
    return Expected(law, law != UNIFORM, number / strips, (weight * temperature).mean(axis=2) / weight.mean(axis=2))


def _course(log: Log, axis: int, places: np.ndarray, discs: Composition) -> tuple[str, np.ndarray, np.ndarray] | None:
    """Name of the law, and relative density and temperature at the coordinates `places` (S, K, P); None if unknown."""
    one = np.ones_like(places)
    properties = log.scene.properties
    low, high = (properties.emits[side] for side in sides_across(axis))
    if len(properties.temperatures) == 2 and low is not None and high is not None:
        others = properties.bath is not None or any(
            properties.emits[side] is not None for side in sides_across(1 - axis)
        )
        if not properties.straight_flight or not properties.lossless or low == high or others:
            return None
        power = low**1.5 + (high**1.5 - low**1.5) * places / log.box[axis]
        temperature = power ** (2 / 3)
        return "T^(3/2) in a straight line between the walls, nT the same (Fourier)", 1 / temperature, temperature
    if log.gravity[axis]:
        if (t := column_temperature(log, axis, discs)) is None:
            return None
        weight = np.exp(discs.mass[:, None, None] * log.gravity[axis] * (places - log.box[axis] / 2) / t)
        return f"barometric: n ~ exp(-m g h/T), T = {t:.6g} at all heights", weight, t * one
    equilibrium = known_ensemble(log)
    if equilibrium is None:
        return None
    return UNIFORM, one, equilibrium.of_species[:, None, None] * one
