"""Thermal walls in a run: their temperatures by number, and how often each disc was emitted."""

import numpy as np

from idealgas.events import Column
from idealgas.physics.thermal import Thermal
from idealgas.run.effects.slice import Slice
from idealgas.scene import Scene
from idealgas.scene.tables.thermal import wall_temperatures
from idealgas.state import Gas

EMISSIONS = Column("emissions", "u8")


def temperature_of_walls(scene: Scene) -> np.ndarray:
    """(walls,) f8, of the sides and then the segments; -1 for those that reflect."""
    temperatures = wall_temperatures(scene.box.sides, scene.wall)
    return np.array([-1.0 if temperature is None else temperature for temperature in temperatures])


def _make(scene: Scene, gas: Gas) -> Thermal | None:
    temperature = temperature_of_walls(scene)
    if not (temperature >= 0).any():
        return None
    return Thermal(temperature, np.uint64(scene.scene.seed), np.zeros(len(gas), np.uint64))


SLICE = Slice(
    "thermal",
    _make,
    disc_state=lambda thermal: {EMISSIONS: thermal.emissions},
    gives_energy=lambda thermal: True,
)
