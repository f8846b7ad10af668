"""A dilute gas in equilibrium under gravity along one axis: its temperature, collision rates and wall hits.

The centres of the discs of species i, of mass m and radius R, are at heights h above the lowest that they can reach,
with the density exp(-m g h/T) up to the length H of the box less 2R.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.analysis.theory import hard_discs
from idealgas.physics.collision_rates import contact_value

DENSEST = 0.2
"""Largest packing fraction of the lowest layer at which the law of a dilute column says anything."""

LAYERS = 2000

TOP = 60.0
"""Scale heights above which there is no disc."""


def barometric_temperature(
    energy: float, freedom: float, mass: np.ndarray, number: np.ndarray, pull: float, height: np.ndarray
) -> float:
    """Temperature (energy, k_B = 1) at which a dilute column has an energy.

    Args:
        energy: of motion, spin and height of all discs, from all of them at the lowest place.
        freedom: number of degrees of freedom of motion and spin of all discs.
        mass: (S,), of a disc of each species.
        number: (S,), of discs of each species.
        pull: size of the acceleration, length/time².
        height: (S,), length that the centres can reach along the acceleration.
    """
    from scipy.optimize import brentq  # which would take a tenth of the time of commands about gases that do not fall

    def excess(t: float) -> float:
        x = mass * pull * height / t
        with np.errstate(over="ignore"):
            above = height * (1 / x - 1 / np.expm1(x))  # mean of h with the weight exp(-x h/height)
        return freedom * t / 2 + float((number * mass * pull * above).sum()) - energy

    scale = max(energy, 1e-300) / float(number.sum())
    return float(brentq(excess, 1e-3 * scale, 2 * scale))


class ColumnRates(NamedTuple):
    """Rates of a column in equilibrium, in 1/time, by Enskog's theory with the local density in thin layers.

    per_disc: (S,), collisions of one disc of each species. pairs, hits: pair collisions and wall hits of the whole gas.
    densest: packing fraction of the lowest layer, no unit.
    """

    per_disc: np.ndarray
    pairs: float
    hits: float
    densest: float


def column_rates(
    temperature: float,
    mass: np.ndarray,
    radius: np.ndarray,
    number: np.ndarray,
    pull: float,
    length: float,
    across: float,
) -> ColumnRates:
    """Rates of a column of S species in a box with walls on all sides.

    Args:
        temperature: energy (k_B = 1).
        mass: (S,), of a disc of each species.
        radius: (S,), length.
        number: (S,), of discs.
        pull: size of the acceleration, length/time².
        length: of the box along the acceleration.
        across: of the box across it, length.
    """
    length = min(length, TOP * temperature / (float(mass.min()) * pull) + 2 * float(radius.max()))
    layer, wide = length / LAYERS, across - 2 * radius
    above = (np.arange(LAYERS) + 0.5) * layer - radius[:, None]
    inside = (above > 0) & (above < length - 2 * radius[:, None])
    weight = np.where(inside, np.exp(-np.clip(mass[:, None] * pull * above / temperature, 0, 700)), 0.0)
    share = weight / weight.sum(axis=1, keepdims=True)  # of the discs of a species in each layer
    density = number[:, None] * share / (wide[:, None] * layer)
    packing = math.pi * radius**2 @ density
    met = (share * contact_value(np.minimum(packing, 0.5))) @ density.T  # Σ over layers, with the crowding there
    others = np.maximum(number - np.eye(len(number)), 0) / number  # a disc does not meet itself
    rate = 2 * np.add.outer(radius, radius) * met * others * hard_discs.mean_relative_speeds(temperature, mass)
    flux = hard_discs.mean_speed(temperature, mass) / math.pi
    floor = wide * density[np.arange(len(mass)), inside.argmax(axis=1)]
    far = wide * density[np.arange(len(mass)), LAYERS - 1 - inside[:, ::-1].argmax(axis=1)]
    hits = float((flux * (2 * number / wide + floor + far)).sum())
    per_disc = rate.sum(axis=1)
    return ColumnRates(per_disc, float(number @ per_disc) / 2, hits, float(packing.max()))
