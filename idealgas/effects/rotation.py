"""Rotation of rough discs."""

import numpy as np
from pydantic import Field

from idealgas.columns import ANGULAR_VELOCITY, Arrays, Column
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.physics import rotation as law
from idealgas.physics.steering import reversed_velocity
from idealgas.state import Gas, rng
from idealgas.toml.table import Real, Table

INERTIA = Column("inertia", "f8", (), "mass length^2")


class RotationTable(Table):
    """`[rotation]`: discs spin, and a coefficient of tangential restitution couples their spins to their translation.

    The coefficient ranges from -1 (smooth) to 1 (perfectly rough); at these two values energy is conserved. Pistons are
    smooth.
    """

    inertia: Real = Field(
        default=0.5, gt=0, le=1, description="moment of inertia in units of mass * radius²: 0.5 for a uniform disc"
    )
    roughness: Real = Field(
        default=1.0, ge=-1, le=1, description="coefficient of tangential restitution for two discs, -1 to 1"
    )
    wall_roughness: Real = Field(
        default=-1.0, ge=-1, le=1, description="coefficient of tangential restitution for a disc and a wall, -1 to 1"
    )


def loses(rotation: RotationTable | None) -> bool:
    """Whether collisions of rough discs, with each other or with walls, lose energy."""
    return rotation is not None and any(-1 < r < 1 for r in (rotation.roughness, rotation.wall_roughness))


class RotationEffect(Effect[law.Rotation]):
    """Rotation of rough discs."""

    name = "rotation"
    field = "rotation"
    key = "rotation"
    table = RotationTable
    description = "[rotation]: inertia, roughness, wall_roughness"
    energy_part = "rotational"
    energy_column = Column("rotational_energy", "f8", (), "energy")
    energy_is_inner = True
    shearable = True
    samples = (BenchmarkSample(tables=lambda side: "[rotation]\nroughness = 0.5\nwall_roughness = 0.5\n"),)

    def properties(self, tables: Tables) -> Properties:
        rotation = tables.table
        return Properties(
            dissipative=loses(rotation), inertia=rotation.inertia, has_rough_walls=rotation.wall_roughness > -1
        )

    def make(self, tables: Tables, start: GasAtStart) -> law.Rotation:
        table, gas = tables.table, start.gas
        omega, inertias = start.angular_velocity.copy(), law.moment_of_inertia(table.inertia, gas.mass, gas.radius)
        for k, name in enumerate(gas.species_names):
            ids = np.flatnonzero(gas.species == k)
            if len(ids) and (temperature := start.spin_temperature[ids[0]]) > 0:
                spin = rng(start.seed, f"spins {name}").standard_normal(len(ids))
                omega[ids] = spin * np.sqrt(temperature / (inertias[ids] * (spin**2).mean()))
        return law.Rotation(omega, inertias, table.roughness, table.wall_roughness)

    def disc_state(self, rotation: law.Rotation) -> Arrays:
        return {ANGULAR_VELOCITY: rotation.omega}

    def constants(self, rotation: law.Rotation) -> Arrays:
        return {ANGULAR_VELOCITY: rotation.omega.copy(), INERTIA: rotation.inertia}

    def energy(self, rotation: law.Rotation, _: Gas, __: float) -> float:
        return float((0.5 * rotation.inertia * rotation.omega**2).sum())

    def gives_energy(self, rotation: law.Rotation) -> bool:
        return abs(rotation.wall_roughness) < 1

    def reverse(self, rotation: law.Rotation) -> None:
        rotation.omega[:] = reversed_velocity(rotation.omega)


EFFECT = RotationEffect()
