"""Gravity in a run: its acceleration, and the potential energy of the discs."""

import numpy as np

from idealgas.events import Column
from idealgas.physics.gravity import Gravity
from idealgas.run.effects.slice import EnergyPart, Slice
from idealgas.scene import Scene
from idealgas.state import Gas


def _make(scene: Scene, _: Gas) -> Gravity | None:
    return Gravity(*scene.gravity.acceleration) if scene.gravity else None


def _energy(gravity: Gravity, gas: Gas, _: float) -> float:
    return -float((gas.mass * (gas.position @ np.array(gravity))).sum())


SLICE = Slice("gravity", _make, energy=EnergyPart("potential", _energy, Column("potential_energy", "f8", (), "energy")))
