"""A dilute gas in equilibrium under gravity along one axis: its temperature, collision rates and wall hits.

The height h of a disc of mass m and radius R is that of its centre above the lowest point that the centre can reach.
The number density of its species is proportional to exp(-m g h/T) up to h = H - 2R, where H is the length of the box
along the acceleration.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.physics.collision_rates import contact_value
from idealgas.theory import hard_discs

DENSEST = 0.2
"""Largest packing fraction of the lowest layer for which a column is treated as dilute."""

LAYERS = 2000

HEIGHTS, POINTS = 257, 513
"""Number of heights, and number of integration points for each height, for a column of fixed energy."""

TOP = 60.0
"""Height above which there are no discs, in scale heights T/mg of the lightest species."""


def barometric_temperature(
    energy: float, freedom: float, mass: np.ndarray, number: np.ndarray, pull: float, height: np.ndarray
) -> float:
    """Return the temperature (energy, k_B = 1) at which a dilute column has a given energy.

    Args:
        energy: kinetic, rotational and gravitational energy of all discs; it is 0 if all are at rest at the lowest
            height.
        freedom: number of degrees of freedom of translation and spin of all discs.
        mass: (S,), mass of a disc of each species.
        number: (S,), number of discs of each species.
        pull: magnitude of the acceleration, length/time².
        height: (S,), length available to the centres along the acceleration.
    """
    from scipy.optimize import brentq  # importing it at the top would slow other commands by a tenth

    def excess(t: float) -> float:
        x = mass * pull * height / t
        with np.errstate(over="ignore"):
            above = height * (1 / x - 1 / np.expm1(x))  # mean of h weighted by exp(-x h/height)
        return freedom * t / 2 + float((number * mass * pull * above).sum()) - energy

    scale = max(energy, 1e-300) / float(number.sum())
    return float(brentq(excess, 1e-3 * scale, 2 * scale))


class ColumnProfile(NamedTuple):
    """Relative density and temperature of a species at heights (H,).

    Both are 0 at heights that a disc cannot reach with the available energy.

    Attributes:
        above: heights above the lowest position of the species, length.
        density: density relative to that at the bottom.
        temperature: temperature, energy.
    """

    above: np.ndarray
    density: np.ndarray
    temperature: np.ndarray


def fixed_energy_column(
    energy: float, dof: float, mass: np.ndarray, number: np.ndarray, pull: float, height: np.ndarray
) -> list[ColumnProfile]:
    """Return the profile of each species of a dilute column at fixed energy.

    If a disc is at height h, the other discs and the motion of all discs share the energy E' = E - m g h. The density
    of discs at h is proportional to the density of states G'(E'), and the temperature there is G/G'. G is the inverse
    Laplace transform of Π z(β)/β^(D/2+1), where z is the mean of exp(-β m g h) over the heights available to each other
    disc. The integration path passes through the saddle point, where 1/β is the temperature of a column of energy E'.
    For N discs in a tall box, T = (E - m g h)/(D/2+N-1).

    The arguments are those of `barometric_temperature`; dof is the number D of degrees of freedom.
    """
    # beyond `reach` the integrand is below 1e-17, or below 1e-6 if `reach` is limited to 1e3
    width, reach = math.sqrt(2 / dof), min(math.sqrt(10 ** (68 / dof) - 1), 1e3)
    u = np.linspace(0.0, math.asinh(reach / width), POINTS)
    step = width * np.cosh(u)
    step[0] /= 2
    profiles = []
    for s, (m, top) in enumerate(zip(mass.tolist(), height.tolist(), strict=True)):
        partners = number - (np.arange(len(number)) == s)
        above = np.linspace(0.0, min(top, energy / (m * pull)), HEIGHTS)
        weight, temperature = np.full(HEIGHTS, -math.inf), np.zeros(HEIGHTS)
        for k, left in enumerate(energy - m * pull * above):
            if left <= 1e-9 * energy:
                break
            saddle = 1 / barometric_temperature(left, dof, mass, partners, pull, height)
            beta = saddle * (1 + 1j * width * np.sinh(u))
            x = np.multiply.outer(beta, mass * pull * height)
            exponent = beta * left - dof / 2 * np.log(beta) + np.log(-np.expm1(-x) / x) @ partners
            states = np.exp(exponent - exponent[0].real) * step
            weight[k] = exponent[0].real + math.log(states.real.sum() * saddle)
            temperature[k] = (states / beta).real.sum() / states.real.sum()
        profiles.append(ColumnProfile(above, np.exp(weight - weight[0]), temperature))
    return profiles


class ColumnRates(NamedTuple):
    """Rates of events in a column in equilibrium, 1/time, from Enskog theory at the local density of each thin layer.

    Attributes:
        per_disc: (S,), collisions of one disc of each species.
        pairs: pair collisions of the whole gas.
        hits: wall hits of the whole gas.
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
    """Return the rates of a column of S species in a box with walls on all sides.

    Args:
        temperature: temperature, energy (k_B = 1).
        mass: (S,), mass of a disc of each species.
        radius: (S,), radius of a disc of each species, length.
        number: (S,), number of discs of each species.
        pull: magnitude of the acceleration, length/time².
        length: length of the box along the acceleration.
        across: length of the box perpendicular to the acceleration.
    """
    length = min(length, TOP * temperature / (float(mass.min()) * pull) + 2 * float(radius.max()))
    layer, wide = length / LAYERS, across - 2 * radius
    above = (np.arange(LAYERS) + 0.5) * layer - radius[:, None]
    inside = (above > 0) & (above < length - 2 * radius[:, None])
    weight = np.where(inside, np.exp(-np.clip(mass[:, None] * pull * above / temperature, 0, 700)), 0.0)
    share = weight / weight.sum(axis=1, keepdims=True)  # fraction of the discs of a species in each layer
    density = number[:, None] * share / (wide[:, None] * layer)
    packing = math.pi * radius**2 @ density
    met = (share * contact_value(np.minimum(packing, 0.5))) @ density.T  # sum over layers, each with its contact value
    partners = np.maximum(number - np.eye(len(number)), 0) / number  # a disc does not collide with itself
    rate = 2 * np.add.outer(radius, radius) * met * partners * hard_discs.mean_relative_speeds(temperature, mass)
    flux = hard_discs.mean_speed(temperature, mass) / math.pi
    floor = wide * density[np.arange(len(mass)), inside.argmax(axis=1)]
    far = wide * density[np.arange(len(mass)), LAYERS - 1 - inside[:, ::-1].argmax(axis=1)]
    hits = float((flux * (2 * number / wide + floor + far)).sum())
    per_disc = rate.sum(axis=1)
    return ColumnRates(per_disc, float(number @ per_disc) / 2, hits, float(packing.max()))
