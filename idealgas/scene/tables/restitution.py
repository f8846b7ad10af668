"""The table of inelastic collisions."""

import math
from collections.abc import Sequence

from pydantic import Field

from idealgas.document.table import Positive, Table
from idealgas.scene.defaults import mean_speed
from idealgas.scene.properties import Effect, Properties
from idealgas.scene.tables.discs import Disc, Species

NAME = "restitution"


class Restitution(Table):
    """`[restitution]`: discs part more slowly than they met.

    A disc that collided less than the contact duration ago collides elastically: this keeps a gas from infinitely many
    collisions in a finite time (Luding & McNamara, Granular Matter 1, 113 (1998)).
    """

    normal: float = Field(default=1.0, ge=0, le=1, description="of two discs, 0 to 1")
    wall: float = Field(default=1.0, ge=0, le=1, description="of a disc with a wall or piston, 0 to 1")
    contact_duration: Positive | None = Field(
        default=None, description="time > 0; if absent 1e-6 * mean diameter / mean speed at the start"
    )

    @property
    def elastic(self) -> bool:
        """Whether nothing is lost."""
        return self.normal == 1 and self.wall == 1


def contact_duration(restitution: Restitution, species: Sequence[Species], disc: Sequence[Disc]) -> float:
    """As given, or a millionth of the mean diameter over the mean speed at the start; infinite if nothing moves."""
    if restitution.contact_duration is not None:
        return restitution.contact_duration
    diameters = sum(2 * s.radius * s.count for s in species) + sum(2 * d.radius for d in disc)
    speed = mean_speed(species, disc)
    number = sum(s.count for s in species) + len(disc)
    return 1e-6 * diameters / number / speed if speed > 0 else math.inf


def effect(restitution: Restitution | None) -> Effect | None:
    """What restitution changes, if anything is lost."""
    if restitution is None or restitution.elastic:
        return None
    return Effect(NAME, (("restitution",),), Properties(uniform=False, elastic=False, lossless=False))
