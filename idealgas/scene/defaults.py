"""Mean speeds and energies that follow from the discs at the start, and the motion of discs that have come to rest."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from idealgas.scene.tables import Run, Species


def mean_speed(species: Sequence[Species], velocity: np.ndarray) -> float:
    """Expected mean speed of species and of discs with velocities (n, 2) at the start, length/time."""
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
    """Mean kinetic energy of species and of discs with masses (n,) and velocities (n, 2) at the start, energy."""
    total = float(mass @ (velocity**2).sum(axis=1)) / 2
    for s in species:
        masses = np.repeat([size.mass for size in s.sizes], [size.number for size in s.sizes])
        if s.velocities is not None:
            total += float(masses @ (np.array(s.velocities).reshape(-1, 2) ** 2).sum(axis=1)) / 2
        else:
            total += s.count * (s.temperature or 0.0) + (s.speed or 0.0) ** 2 * float(masses.sum()) / 2
    return total / max(len(velocity) + sum(s.count for s in species), 1)


def reference_speed(run: Run, largest: float) -> float:
    """Reference speed of the Monte Carlo method, length/time; by default five times the largest speed at the start."""
    return run.v_ref or 5.0 * largest


@dataclass(frozen=True)
class RestingDisc:
    """A disc that has come to rest on a wall or disc against which a constant force presses it.

    It keeps bouncing without loss, because each hit comes less than a contact duration t after the previous one. With
    the acceleration a, its speed is at most a t/2.

    Attributes:
        hits: smallest and largest rate of hits of the disc, 1/t and 1/(et), 1/time.
        height: largest height of its bounces, a t²/8, length.
        energy: largest energy of its bounces divided by the disc's mass, a² t²/8, (length/time)².
        per_free_time: largest number of its hits in a mean free time of the gas at the start. This number and the
            largest rate are None for a coefficient e = 0, for which the disc has endless collisions at one instant.
    """

    hits: tuple[float, float | None]
    height: float
    energy: float
    per_free_time: float | None
