"""Andersen thermostat: at random times a disc receives a random velocity at the temperature of a heat bath.

The collisions of each disc with the bath are an independent Poisson process, so the gas approaches the canonical
ensemble at any rate: Andersen, J. Chem. Phys. 72, 2384 (1980). The times and velocities are a pure function of the
seed, the disc's id and the index of the collision (SplitMix64: Steele, Lea & Flood, OOPSLA 2014), so they depend
neither on the order of events nor on whether a run was resumed.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.jit import inline, njit
from idealgas.physics.elementary import cos_sin_turns, log
from idealgas.physics.random_numbers import disc_uniform


class Thermostat(NamedTuple):
    """Parameters of the heat bath, and each disc's next collision with the bath.

    Attributes:
        temperature: temperature of the bath, mass length²/time² (k_B = 1).
        rate: rate at which each disc collides with the bath, 1/time.
        seed: seed of the scene.
        time: (N,) f8 by id, local time of each disc's next collision with the bath.
        number: (N,) u8 by id, index of each disc's next collision with the bath, from 0.
    """

    temperature: float
    rate: float
    seed: np.uint64
    time: np.ndarray
    number: np.ndarray


@inline
def uniform(thermostat, disc_id, draw):
    """Random number in (0, 1] for a disc's next collision with the bath.

    draw: 3 for its time, 4 and 5 for the velocity, 6 and 7 for the spin.
    """
    return disc_uniform(thermostat.seed, disc_id, thermostat.number[np.uintp(disc_id)], draw)


@inline
def interval(thermostat, disc_id):
    """Time between two collisions of a disc with the bath, exponentially distributed with mean 1/rate."""
    return -log(uniform(thermostat, disc_id, 3)) / thermostat.rate


@njit
def draw_first_collisions(thermostat):
    """Draw the local time, counted from 0, of every disc's first collision with the bath."""
    for disc_id in range(thermostat.time.shape[0]):
        thermostat.time[disc_id] = interval(thermostat, disc_id)


@inline
def andersen_collision(disc, disc_id, thermostat, rotation):
    """Give a disc that collides with the bath a random velocity and spin, and draw the time of its next collision.

    The disc must be at the time of the collision. Each component of the velocity is Gaussian with variance T/m, and the
    spin is Gaussian with variance T/I.
    """
    if thermostat is not None:
        u = np.uintp(disc_id)
        temperature = thermostat.temperature
        speed = math.sqrt(-2.0 * temperature / disc.m * log(uniform(thermostat, disc_id, 4)))
        cos, sin = cos_sin_turns(uniform(thermostat, disc_id, 5))
        disc.vx = speed * cos
        disc.vy = speed * sin
        if rotation is not None:
            spin = math.sqrt(-2.0 * temperature / rotation.inertia[u] * log(uniform(thermostat, disc_id, 6)))
            rotation.omega[u] = spin * cos_sin_turns(uniform(thermostat, disc_id, 7))[0]
        thermostat.number[u] += np.uint64(1)
        thermostat.time[u] += interval(thermostat, disc_id)


def end_epoch(thermostat: Thermostat, length: float) -> None:
    """Shift the local times of the next collisions so that they count from the end of the epoch.

    length: duration of the epoch, time.
    """
    thermostat.time[:] -= length
