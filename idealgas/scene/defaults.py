"""Defaults that follow from several tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from idealgas.physics.collision_rates import DENSEST, collisions_per_length, mean_trial_time

if TYPE_CHECKING:
    from idealgas.scene.tables.discs import Disc, Species
    from idealgas.scene.tables.run import Run
    from idealgas.toml.table import Rectangle, Vector


def mean_speed(species: Sequence[Species], disc: Sequence[Disc]) -> float:
    """Expected mean speed of the discs at the start, length/time."""
    speeds = [math.hypot(*d.velocity) for d in disc]
    for s in species:
        if s.velocities is not None:
            speeds += [math.hypot(*v) for v in s.velocities]
    spread = sum(
        s.count * (s.speed or math.sqrt(math.pi * (s.temperature or 0.0) / (2 * s.mass)))
        for s in species
        if s.velocities is None
    )
    return (sum(speeds) + spread) / (len(disc) + sum(s.count for s in species))


def number_of_discs(species: Sequence[Species], disc: Sequence[Disc]) -> int:
    """Number of all discs."""
    return sum(s.count for s in species) + len(disc)


def sum_of_diameters(species: Sequence[Species], disc: Sequence[Disc]) -> float:
    """Sum of the diameters of all discs, length."""
    return sum(2 * s.radius * s.count for s in species) + sum(2 * d.radius for d in disc)


def mean_free_time(
    species: Sequence[Species], disc: Sequence[Disc], room: Rectangle, periodic: tuple[bool, bool], body_force: Vector
) -> float:
    """Expected time between two collisions of a disc, with discs and sides, time; infinite if nothing moves.

    room: what the discs have at the start. periodic: whether the sides along x and along y are. body_force: constant
    acceleration, length/time². The speed is that of a disc with the mean speed at the start after a fall through half
    of the room.
    """
    n = number_of_discs(species, disc)
    radii = [(s.radius, s.count) for s in species] + [(d.radius, 1) for d in disc]
    size = room[2] - room[0], room[3] - room[1]
    phi = math.pi * math.fsum(r * r * count for r, count in radii) / (size[0] * size[1])
    diameter = sum_of_diameters(species, disc) / n
    encounters = collisions_per_length(n, diameter, max(radii)[0], phi, size, periodic) / n
    way = 1.0 / max(encounters, 1.0 / sum(size))
    speed = math.sqrt(mean_speed(species, disc) ** 2 + abs(body_force[0]) * size[0] + abs(body_force[1]) * size[1])
    return way / speed if speed > 0 else math.inf


def reference_speed(run: Run, largest: float) -> float:
    """As given, or five times the largest speed at the start."""
    return run.v_ref or 5.0 * largest


def trial_time(run: Run, species: Sequence[Species], disc: Sequence[Disc], size: tuple[float, float]) -> float:
    """Expected time between two trials of Monte Carlo, time; infinite if nothing moves. size: of the box, length."""
    n, speed = number_of_discs(species, disc), reference_speed(run, mean_speed(species, disc))
    if n < 2 or speed == 0:
        return math.inf
    covered = math.pi * math.fsum([s.radius**2 * s.count for s in species] + [d.radius**2 for d in disc])
    largest = max([s.radius for s in species] + [d.radius for d in disc])
    area = size[0] * size[1]
    return mean_trial_time(n, area, min(covered / area, DENSEST), 2 * largest, speed)
