"""A piston in a run: its record, where the log keeps it, and its energy if it has a mass."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from idealgas.events import Column, Values
from idealgas.jit import aligned
from idealgas.physics.piston import PISTON, piston_energy, piston_motion
from idealgas.run.effects.slice import EnergyPart, Slice
from idealgas.scene import Scene
from idealgas.sides import SIDES
from idealgas.state import Gas

POSITION = Column("piston_position", "f8", (), "length")
VELOCITY = Column("piston_velocity", "f8", (), "length/time")


def _make(scene: Scene, _: Gas) -> np.ndarray | None:
    if scene.piston is None:
        return None
    table, size = scene.piston, scene.box.size
    piston = aligned(1, PISTON)
    record = piston[0]
    record.x, record.v, record.a = table.start(size), table.velocity or 0.0, table.acceleration(size, scene.gravity)
    record.m, record.stop, record.side = table.mass or 0.0, table.stop(size), SIDES.index(table.side)
    return piston


def _values(piston: np.ndarray, local_time: float) -> Values:
    position, velocity = piston_motion(piston[0], local_time)
    return {POSITION: float(position), VELOCITY: float(velocity)}


def _restore(piston: np.ndarray, values: Mapping[str, Any]) -> None:
    record = piston[0]
    record.x, record.v, record.t = values[POSITION.name], values[VELOCITY.name], 0.0


def _energy(piston: np.ndarray, _: Gas, local_time: float) -> float:
    record = piston[0]
    position, velocity = piston_motion(record, local_time)
    return float(piston_energy(record.m, position, velocity, record.a)) if record.m > 0 else 0.0


def _own_wall(piston: np.ndarray) -> int | None:
    return int(piston[0].side) if piston[0].m > 0 else None


SLICE = Slice(
    "piston",
    _make,
    values=_values,
    restore=_restore,
    energy=EnergyPart("piston", _energy),
    gives_energy=lambda piston: True,
    own_wall=_own_wall,
)
