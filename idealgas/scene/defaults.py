"""Defaults that follow from several tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from idealgas.physics.collision_rates import DENSEST, collisions_per_length, mean_trial_time

if TYPE_CHECKING:
    from idealgas.effects.restitution import Restitution
    from idealgas.scene.tables import Disc, Run, Species
    from idealgas.toml.table import Rectangle, Vector


SHARE = 0.05
"""Default contact duration in units of the mean free time, where a constant force presses discs together."""

SHORTEST = 1e-6
"""Default contact duration in units of the time for a mean diameter at the mean speed, where no force does."""


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


@dataclass(frozen=True)
class RestingDisc:
    """A disc that has come to rest on a wall or disc to which a constant force presses it.

    It keeps bouncing without loss, as each of its hits comes less than a contact duration t after the previous one:
    with the acceleration a its speed is a t/2 at most.

    hits: (least, most) hits of one disc per time, 1/t and 1/(et), 1/time. height: largest height of its bounces,
    a t²/8, length. energy: their largest energy divided by the disc's mass, a² t²/8, (length/time)². per_free_time:
    most hits of it in a mean free time of the gas at the start. The most is None for a coefficient e = 0: the disc then
    collides without end at one instant.
    """

    hits: tuple[float, float | None]
    height: float
    energy: float
    per_free_time: float | None


def resting_disc(restitution: Restitution, duration: float, free_time: float, body_force: Vector) -> RestingDisc | None:
    """What discs do at rest; None if no constant force presses them, or nothing is lost.

    duration: contact duration, time. free_time: mean free time at the start, time. body_force: acceleration,
    length/time².
    """
    force = math.hypot(*body_force)
    if force == 0 or restitution.elastic:
        return None
    e = min(restitution.normal, restitution.wall)
    most = 1 / (e * duration) if e > 0 else None
    height, energy = force * duration**2 / 8, (force * duration) ** 2 / 8
    return RestingDisc((1 / duration, most), height, energy, None if most is None else most * free_time)


def contact_duration(
    restitution: Restitution,
    species: Sequence[Species],
    disc: Sequence[Disc],
    room: Rectangle,
    periodic: tuple[bool, bool],
    body_force: Vector,
) -> float:
    """As given, or by default, time; infinite if nothing ever moves.

    A constant force presses a disc that has come to rest on the wall below it, so the default bounds its hits
    by a multiple of those of the gas: it is a twentieth of the mean free time. Without such a force the discs of a
    cluster part as soon as their collisions are elastic, and the default only has to end the collapse: it is a
    millionth of the time in which a disc moves by its diameter, which no average can tell from zero.

    room, periodic, body_force: see `mean_free_time`.
    """
    if restitution.contact_duration is not None:
        return restitution.contact_duration
    if any(body_force):
        return SHARE * mean_free_time(species, disc, room, periodic, body_force)
    speed = mean_speed(species, disc)
    if speed == 0:
        return math.inf
    return SHORTEST * sum_of_diameters(species, disc) / number_of_discs(species, disc) / speed
