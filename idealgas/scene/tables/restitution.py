"""The table of inelastic collisions."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from pydantic import Field

from idealgas.scene.defaults import mean_free_time, mean_speed, number_of_discs, sum_of_diameters
from idealgas.scene.properties import Effect, Properties
from idealgas.scene.tables.discs import Disc, Species
from idealgas.toml.table import Positive, Real, Rectangle, Table, Vector

SHARE = 0.05
"""Default contact duration in units of the mean free time, where a constant force presses discs together."""

SHORTEST = 1e-6
"""Default contact duration in units of the time for a mean diameter at the mean speed, where no force does."""

NAME = "restitution"


class Restitution(Table):
    """`[restitution]`: discs part more slowly than they met.

    A disc that collided less than the contact duration ago collides elastically: this keeps a gas from infinitely many
    collisions in a finite time (Luding & McNamara, Granular Matter 1, 113 (1998)).
    """

    normal: Real = Field(default=1.0, ge=0, le=1, description="of two discs, 0 to 1")
    wall: Real = Field(default=1.0, ge=0, le=1, description="of a disc with a wall or piston, 0 to 1")
    contact_duration: Positive | None = Field(
        default=None, description="time > 0; if absent 0.05 of the mean free time, or without a force far less"
    )

    @property
    def elastic(self) -> bool:
        """Whether nothing is lost."""
        return self.normal == 1 and self.wall == 1


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


def rest(restitution: Restitution, duration: float, free_time: float, body_force: Vector) -> RestingDisc | None:
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


def effect(restitution: Restitution | None) -> Effect | None:
    """What restitution changes, if anything is lost."""
    if restitution is None or restitution.elastic:
        return None
    return Effect(NAME, (("restitution",),), Properties(uniform=False, elastic=False, dissipative=True))
