"""Thermal walls: discs leave a wall with the velocity distribution of a gas that effuses at the wall's temperature.

The normal velocity v has probability density (m v/T) exp(-m v²/2T); the tangential velocity and the spin are Gaussian.
The random numbers are a pure function of the seed, the disc's id and the number of times that walls have emitted the
disc (SplitMix64: Steele, Lea & Flood, OOPSLA 2014), so they depend neither on the order of discs in memory nor on
whether a run was resumed.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.jit import inline
from idealgas.physics.elementary import cos_sin_turns, log
from idealgas.physics.random_numbers import disc_uniform


class Thermal(NamedTuple):
    """Temperatures of the walls, and the state of the random numbers.

    Attributes:
        temperature: (walls,) f8, mass length²/time² (k_B = 1); negative for a wall that reflects.
        seed: seed of the scene.
        emissions: (N,) u8 by id, number of times that walls have emitted each disc.
    """

    temperature: np.ndarray
    seed: np.uint64
    emissions: np.ndarray


@inline
def is_thermal(thermal, wall):
    """Whether a wall has a temperature and emits the discs that hit it."""
    if thermal is not None:
        return thermal.temperature[np.uintp(wall)] >= 0.0
    return False


@inline
def uniform(thermal, disc_id, draw):
    """Random number in (0, 1] for a disc's current emission.

    draw: index of the random number within the emission.
    """
    return disc_uniform(thermal.seed, disc_id, thermal.emissions[np.uintp(disc_id)], draw)


@inline
def emit(disc, disc_id, nx, ny, wall, thermal, rotation):
    """Give a disc a random velocity away from a wall, and a random spin, at the wall's temperature.

    wall: number of the wall.
    """
    if thermal is not None:
        temperature = thermal.temperature[np.uintp(wall)]
        normal = math.sqrt(-2.0 * temperature / disc.m * log(uniform(thermal, disc_id, 0)))
        radius = math.sqrt(-2.0 * log(uniform(thermal, disc_id, 1)))
        cos, sin = cos_sin_turns(uniform(thermal, disc_id, 2))
        tangent = math.sqrt(temperature / disc.m) * radius * cos
        disc.vx = normal * nx - tangent * ny
        disc.vy = normal * ny + tangent * nx
        if rotation is not None:
            u = np.uintp(disc_id)
            rotation.omega[u] = math.sqrt(temperature / rotation.inertia[u]) * radius * sin
        thermal.emissions[np.uintp(disc_id)] += np.uint64(1)
