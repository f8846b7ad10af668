"""Inelastic collisions of discs with each other and with walls."""

import math

import numpy as np
from pydantic import Field

from idealgas.columns import Column
from idealgas.effects.effect import EffectSpec, Sample, Start, Tables
from idealgas.effects.properties import Properties
from idealgas.physics import restitution as law
from idealgas.toml.table import Positive, Real, Table

LAST_COLLISION = Column("last_collision", "f8", (), "time")
"""Time of a disc's last collision, counted from the checkpoint."""


class Restitution(Table):
    """`[restitution]`: discs separate more slowly than they approached.

    A disc that collided less than the contact duration ago collides elastically; this prevents infinitely many
    collisions in a finite time (Luding & McNamara, Granular Matter 1, 113 (1998)).
    """

    normal: Real = Field(default=1.0, ge=0, le=1, description="coefficient of restitution of two discs, 0 to 1")
    wall: Real = Field(
        default=1.0, ge=0, le=1, description="coefficient of restitution of a disc with a wall or piston, 0 to 1"
    )
    contact_duration: Positive | None = Field(
        default=None, description="time > 0; if absent, 0.05 of the mean free time, or far less without a force"
    )

    @property
    def elastic(self) -> bool:
        """Whether collisions do not lose energy."""
        return self.normal == 1 and self.wall == 1


def _properties(tables: Tables) -> Properties | None:
    if tables.own.elastic:
        return None
    return Properties(uniform=False, elastic=False, dissipative=True)


def _make(tables: Tables, start: Start) -> law.Restitution:
    table = tables.own
    return law.Restitution(table.normal, table.wall, table.contact_duration, np.full(len(start.gas), -math.inf))


EFFECT = EffectSpec(
    name="restitution",
    field="restitution",
    key="restitution",
    table=Restitution,
    description="[restitution]: normal, wall, contact_duration",
    properties=_properties,
    make=_make,
    disc_state=lambda restitution: {LAST_COLLISION: restitution.last},
    gives_energy=lambda restitution: restitution.wall < 1,
    end_epoch=law.end_epoch,
    samples=(Sample(tables=lambda side: "[restitution]\nnormal = 0.999\nwall = 0.999\n"),),
)
