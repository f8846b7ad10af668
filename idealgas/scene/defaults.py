"""Mean speed and energy of the discs at the start, and the motion of discs that have come to rest."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from idealgas.scene.tables import Run, Species


def mean_speed(species: Sequence[Species], velocity: np.ndarray) -> float:
    """Return the expected mean initial speed of the discs of all species and of discs with given velocities.

    Args:
        species: species whose velocities are drawn or listed in their tables.
        velocity: (n, 2), velocities of the discs that are given individually, length/time.
    """
    speeds = [math.hypot(*v) for v in velocity.tolist()]
    for s in species:
        if s.velocities is not None:
            speeds += [math.hypot(*v) for v in s.velocities]
    spread = sum(
        size.number * (s.speed or math.sqrt(math.pi * (s.temperature or 0.0) / (2 * size.mass)))
        for s in species
        if s.velocities is None
        for size in s.sizes
    )
    return (sum(speeds) + spread) / max(len(velocity) + sum(s.count for s in species), 1)


def mean_kinetic_energy(species: Sequence[Species], mass: np.ndarray, velocity: np.ndarray) -> float:
    """Return the expected mean initial kinetic energy of the discs of all species and of discs with given velocities.

    Args:
        species: species whose velocities are drawn or listed in their tables.
        mass: (n,), masses of the discs that are given individually.
        velocity: (n, 2), velocities of the discs that are given individually, length/time.
    """
    total = float(mass @ (velocity**2).sum(axis=1)) / 2
    for s in species:
        masses = np.repeat([size.mass for size in s.sizes], [size.number for size in s.sizes])
        if s.velocities is not None:
            total += float(masses @ (np.array(s.velocities).reshape(-1, 2) ** 2).sum(axis=1)) / 2
        else:
            total += s.count * (s.temperature or 0.0) + (s.speed or 0.0) ** 2 * float(masses.sum()) / 2
    return total / max(len(velocity) + sum(s.count for s in species), 1)


def reference_speed(run: Run, largest: float) -> float:
    """Return the reference speed of the Monte Carlo method, length/time; by default five times `largest`."""
    return run.v_ref or 5.0 * largest


@dataclass(frozen=True)
class RestingDisc:
    """A disc that has come to rest on a wall or another disc, against which a constant force presses it.

    The disc keeps bouncing without loss, because each hit follows the previous one within the contact duration t. For
    acceleration a, its speed is at most a t/2.

    Attributes:
        hits: smallest and largest hit rates of the disc, 1/t and 1/(e t), where e is the coefficient of restitution,
            1/time.
        height: largest height of the bounces, a t²/8, length.
        energy: largest energy of the bounces per unit mass of the disc, a² t²/8, (length/time)².
        per_free_time: largest number of hits per initial mean free time of the gas. This number and the largest rate
            are None for e = 0, because the disc would then collide infinitely often at one instant.
    """

    hits: tuple[float, float | None]
    height: float
    energy: float
    per_free_time: float | None
