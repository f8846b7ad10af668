"""Inelastic collisions of discs with each other and with walls."""

import math

import numpy as np
from pydantic import Field

from idealgas.columns import Arrays, Column
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.physics import restitution as law
from idealgas.toml.table import Positive, Real, Table

LAST_COLLISION = Column("last_collision", "f8", (), "time")
"""Time of a disc's last collision, counted from the checkpoint."""


class RestitutionTable(Table):
    """`[restitution]`: discs separate more slowly than they approached each other.

    A disc that collided less than the contact duration ago collides elastically; this prevents infinitely many
    collisions in a finite time (Luding & McNamara, Granular Matter 1, 113 (1998)).
    """

    normal: Real = Field(default=1.0, ge=0, le=1, description="coefficient of restitution for two discs, 0 to 1")
    wall: Real = Field(
        default=1.0, ge=0, le=1, description="coefficient of restitution for a disc and a wall or piston, 0 to 1"
    )
    contact_duration: Positive | None = Field(
        default=None, description="time > 0; if absent, 0.05 mean free times, or far less if no constant force acts"
    )

    @property
    def elastic(self) -> bool:
        """Whether collisions conserve energy."""
        return self.normal == 1 and self.wall == 1


class RestitutionEffect(Effect[law.Restitution]):
    """Inelastic collisions of discs with each other and with walls."""

    name = "restitution"
    field = "restitution"
    key = "restitution"
    table = RestitutionTable
    description = "[restitution]: normal, wall, contact_duration"
    shearable = True
    samples = (BenchmarkSample(tables=lambda side: "[restitution]\nnormal = 0.999\nwall = 0.999\n"),)

    def properties(self, tables: Tables) -> Properties | None:
        if tables.table.elastic:
            return None
        return Properties(uniform=False, elastic=False, dissipative=True)

    def make(self, tables: Tables, start: GasAtStart) -> law.Restitution:
        table = tables.table
        return law.Restitution(table.normal, table.wall, table.contact_duration, np.full(len(start.gas), -math.inf))

    def disc_state(self, restitution: law.Restitution) -> Arrays:
        return {LAST_COLLISION: restitution.last}

    def gives_energy(self, restitution: law.Restitution) -> bool:
        return restitution.wall < 1

    def end_epoch(self, restitution: law.Restitution, length: float) -> None:
        law.end_epoch(restitution, length)


EFFECT = RestitutionEffect()
