"""Thermal walls: a disc leaves with the velocity of a gas at the wall's temperature that streams through its surface.

Normal speed density (m v/T) exp(-m v²/2T), tangential velocity and spin Gaussian. The random numbers are a pure
function of the seed, the disc and the number of its emissions (SplitMix64: Steele, Lea & Flood, OOPSLA 2014), so
neither the order of discs in memory nor a resumed run changes them.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas._jit import inline
from idealgas.physics.random_numbers import GOLDEN, mix, unit_interval


class Thermal(NamedTuple):
    """temperature: (walls,) f8, energy, negative for a wall that reflects. seed: of the scene.

    emissions: (N,) u8 by id, how often each disc was emitted.
    """

    temperature: np.ndarray
    seed: np.uint64
    emissions: np.ndarray


@inline
def is_thermal(thermal, wall):
    """Whether a wall emits."""
    if thermal is not None:
        return thermal.temperature[np.uintp(wall)] >= 0.0
    return False


@inline
def uniform(thermal, own, draw):
    """A number in (0, 1] for a disc's current emission; draw: which of its numbers."""
    key = mix(thermal.seed + GOLDEN * (np.uint64(own) + np.uint64(1)))
    count = thermal.emissions[np.uintp(own)] * np.uint64(8) + np.uint64(draw)
    return unit_interval(mix(mix(key + GOLDEN * (count + np.uint64(1))) + key))


@inline
def emit(disc, own, nx, ny, wall, thermal, rotation):
    """Give a disc a new velocity away from the wall."""
    if thermal is not None:
        temperature = thermal.temperature[np.uintp(wall)]
        normal = math.sqrt(-2.0 * temperature / disc.m * math.log(uniform(thermal, own, 0)))
        radius = math.sqrt(-2.0 * math.log(uniform(thermal, own, 1)))
        angle = 2.0 * math.pi * uniform(thermal, own, 2)
        tangent = math.sqrt(temperature / disc.m) * radius * math.cos(angle)
        disc.vx = normal * nx - tangent * ny
        disc.vy = normal * ny + tangent * nx
        if rotation is not None:
            u = np.uintp(own)
            rotation.omega[u] = math.sqrt(temperature / rotation.inertia[u]) * radius * math.sin(angle)
        thermal.emissions[np.uintp(own)] += np.uint64(1)
