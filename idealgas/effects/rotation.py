"""Rotation of rough discs."""

import numpy as np
from pydantic import Field

from idealgas.columns import ANGULAR_VELOCITY, Arrays, Column
from idealgas.effects.effect import EffectSpec, EnergyPart, Sample, Start, Tables
from idealgas.effects.properties import Properties
from idealgas.physics import rotation as law
from idealgas.physics.steering import reversed_velocity
from idealgas.state import Gas, rng
from idealgas.toml.table import Real, Table

INERTIA = Column("inertia", "f8", (), "mass length^2")


class Rotation(Table):
    """`[rotation]`: discs have a spin, which a tangential coefficient of restitution couples to their motion.

    The coefficient ranges from -1 (smooth) to 1 (perfectly rough); at these two values energy is conserved. A piston is
    smooth.
    """

    inertia: Real = Field(
        default=0.5, gt=0, le=1, description="moment of inertia in units of mass * radius²: 0.5 for a uniform disc"
    )
    roughness: Real = Field(default=1.0, ge=-1, le=1, description="tangential coefficient of two discs, -1 to 1")
    wall_roughness: Real = Field(
        default=-1.0, ge=-1, le=1, description="tangential coefficient of a disc with a wall, -1 to 1"
    )


def loses(rotation: Rotation | None) -> bool:
    """Whether collisions of rough discs, with each other or with walls, lose energy."""
    return rotation is not None and any(-1 < r < 1 for r in (rotation.roughness, rotation.wall_roughness))


def _properties(tables: Tables) -> Properties:
    rotation = tables.own
    return Properties(
        dissipative=loses(rotation), inertia=rotation.inertia, has_rough_walls=rotation.wall_roughness > -1
    )


def _make(tables: Tables, start: Start) -> law.Rotation:
    table, gas = tables.own, start.gas
    omega, inertias = start.angular_velocity.copy(), law.moment_of_inertia(table.inertia, gas.mass, gas.radius)
    for k, name in enumerate(gas.species_names):
        ids = np.flatnonzero(gas.species == k)
        if len(ids) and (temperature := start.spin_temperature[ids[0]]) > 0:
            spin = rng(start.seed, f"spins {name}").standard_normal(len(ids))
            omega[ids] = spin * np.sqrt(temperature / (inertias[ids] * (spin**2).mean()))
    return law.Rotation(omega, inertias, table.roughness, table.wall_roughness)


def _constants(rotation: law.Rotation) -> Arrays:
    return {ANGULAR_VELOCITY: rotation.omega.copy(), INERTIA: rotation.inertia}


def _energy(rotation: law.Rotation, _: Gas, __: float) -> float:
    return float((0.5 * rotation.inertia * rotation.omega**2).sum())


def _reverse(rotation: law.Rotation) -> None:
    rotation.omega[:] = reversed_velocity(rotation.omega)


EFFECT = EffectSpec(
    name="rotation",
    field="rotation",
    key="rotation",
    table=Rotation,
    description="[rotation]: inertia, roughness, wall_roughness",
    properties=_properties,
    make=_make,
    disc_state=lambda rotation: {ANGULAR_VELOCITY: rotation.omega},
    constants=_constants,
    energy=EnergyPart("rotational", _energy, Column("rotational_energy", "f8", (), "energy"), inner=True),
    reverse=_reverse,
    gives_energy=lambda rotation: abs(rotation.wall_roughness) < 1,
    samples=(Sample(tables=lambda side: "[rotation]\nroughness = 0.5\nwall_roughness = 0.5\n"),),
)
