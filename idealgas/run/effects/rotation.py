"""Rough discs in a run: their spins, as the scene gives or draws them, and the energy of these."""

import math

import numpy as np

from idealgas.events import ANGULAR_VELOCITY, Arrays, Column
from idealgas.physics.effects import Effects
from idealgas.physics.rotation import Rotation, moment_of_inertia
from idealgas.run.effects.slice import EnergyPart, Slice
from idealgas.scene import Scene
from idealgas.state import Gas, rng

INERTIA = Column("inertia", "f8", (), "mass length^2")


def _make(scene: Scene, gas: Gas) -> Rotation | None:
    if scene.rotation is None:
        return None
    table = scene.rotation
    omega = [disc.angular_velocity or 0.0 for disc in scene.disc]
    for s in scene.species:
        spin = np.full(s.count, s.angular_velocity or 0.0)
        if s.spin_temperature:
            spin = rng(scene.scene.seed, f"spins {s.name}").standard_normal(s.count)
            inertia = moment_of_inertia(table.inertia, s.mass, s.radius)
            spin *= math.sqrt(s.spin_temperature / (inertia * (spin**2).mean()))
        omega.extend(spin)
    inertias = moment_of_inertia(table.inertia, gas.mass, gas.radius)
    return Rotation(np.array(omega), inertias, table.roughness, table.wall_roughness)


def _constants(rotation: Rotation) -> Arrays:
    return {ANGULAR_VELOCITY: rotation.omega.copy(), INERTIA: rotation.inertia}


def _energy(rotation: Rotation, _: Gas, __: float) -> float:
    return float((0.5 * rotation.inertia * rotation.omega**2).sum())


def _conserves(effects: Effects) -> bool:
    return effects.rotation is None or not abs(effects.rotation.roughness) < 1


SLICE = Slice(
    "rotation",
    _make,
    disc_state=lambda rotation: {ANGULAR_VELOCITY: rotation.omega},
    constants=_constants,
    energy=EnergyPart("rotational", _energy, Column("rotational_energy", "f8", (), "energy"), inner=True),
    gives_energy=lambda rotation: abs(rotation.wall_roughness) < 1,
    loses_energy=lambda rotation: abs(rotation.roughness) < 1 or abs(rotation.wall_roughness) < 1,
    conserves=_conserves,
)
