"""What each effect adds to a log: columns, together with where their values come from."""

from dataclasses import replace
from typing import Any

import numpy as np

from idealgas.events import COLUMN_UNITS
from idealgas.gas.state import Gas
from idealgas.log import Checkpoint, Column, Wall
from idealgas.log.schema import CHECKPOINT_ARRAYS, EVENT_COLUMNS
from idealgas.physics.effects import Effects
from idealgas.run.energy import energy_of, piston_motion
from idealgas.scene import Scene
from idealgas.scene.walls import number_walls

SPIN = Column("angular_velocity", "f8", (), COLUMN_UNITS["angular_velocity"])
IMAGE = Column("image", "i4", (2,), COLUMN_UNITS["image"])
TRIAL = Column("trial", "u8", (), COLUMN_UNITS["trial"])


def walls_of(scene: Scene) -> list[Wall]:
    """The sides of the box and the wall segments, by the numbers events refer to them."""
    return [Wall(wall.name, wall.start, wall.end) for wall in number_walls(scene)]


def boundary_of(scene: Scene) -> tuple[str, str]:
    """What ends the box along each axis, in the words of H5MD."""
    x, y = ("periodic" if periodic else "none" for periodic in scene.box.periodic)
    return x, y


def disc_constants(effects: Effects) -> dict[Column, np.ndarray]:
    """What the log keeps of each disc at the start, beside motion, radius and mass."""
    if effects.rotation is None:
        return {}
    inertia = Column("inertia", "f8", (), "mass length^2")
    return {SPIN: effects.rotation.omega.copy(), inertia: effects.rotation.inertia}


def event_columns(effects: Effects, without_positions: bool) -> tuple[Column, ...]:
    """Of an event's row; homogeneous: the discs have no positions."""
    spin = (SPIN,) if effects.rotation is not None else ()
    image = (IMAGE,) if effects.periodic is not None else ()
    if without_positions:
        return (*(column for column in EVENT_COLUMNS if column.name != "position"), *spin, TRIAL)
    return (*EVENT_COLUMNS, *spin, *image)


def disc_state(gas: Gas, effects: Effects, without_positions: bool) -> dict[Column, np.ndarray]:
    """What a checkpoint keeps of each disc; times count from the checkpoint."""
    position, velocity = CHECKPOINT_ARRAYS
    state = {velocity: gas.velocity} if without_positions else {position: gas.position, velocity: gas.velocity}
    if effects.periodic is not None:
        state[IMAGE] = effects.periodic.image
    if effects.rotation is not None:
        state[SPIN] = effects.rotation.omega
    if effects.restitution is not None:
        state[Column("last_collision", "f8", (), "time")] = effects.restitution.last
    if effects.thermal is not None:
        state[Column("emissions", "u8")] = effects.thermal.emissions
    return state


def snapshot_state(gas: Gas, effects: Effects, without_positions: bool) -> dict[Column, np.ndarray]:
    """What a snapshot keeps of each disc."""
    shown = (*CHECKPOINT_ARRAYS, IMAGE, SPIN)
    return {column: values for column, values in disc_state(gas, effects, without_positions).items() if column in shown}


def restore(gas: Gas, effects: Effects, checkpoint: Checkpoint) -> Gas:
    """The gas at a checkpoint; the effects get the state that they had there. gas: any of the same discs."""
    arrays = checkpoint.arrays
    for name, values in by_name(disc_state(gas, effects, without_positions=True)).items():
        if name != "velocity":
            values[:] = arrays[name]
    if effects.piston is not None:
        record = effects.piston[0]
        record.x, record.v = checkpoint.values["piston_position"], checkpoint.values["piston_velocity"]
        record.t = 0.0
    if effects.wall_energy is not None:
        effects.wall_energy[:] = arrays["wall_energy"]
    return replace(gas, position=arrays.get("position", gas.position).copy(), velocity=arrays["velocity"].copy())


def whole_state(effects: Effects, local_time: float = 0.0) -> dict[Column, Any]:
    """What checkpoints and samples keep of piston and walls; local_time: from the start of the epoch."""
    state: dict[Column, Any] = {}
    if effects.piston is not None:
        position, velocity = piston_motion(effects.piston, local_time)
        state[Column("piston_position", "f8", (), "length")] = position
        state[Column("piston_velocity", "f8", (), "length/time")] = velocity
    if effects.wall_energy is not None:
        state[Column("wall_energy", "f8", (len(effects.wall_energy),), "energy")] = effects.wall_energy.copy()
    return state


def observed(gas: Gas, effects: Effects, local_time: float = 0.0) -> dict[Column, Any]:
    """What a sample adds to the audit: the energy of the discs in all, its parts, piston and walls."""
    energy = energy_of(gas, effects, local_time)
    sample: dict[Column, Any] = {Column("energy", "f8", (), "energy"): energy.gas}
    if effects.rotation is not None:
        sample[Column("rotational_energy", "f8", (), "energy")] = energy.rotational
    if effects.gravity is not None:
        sample[Column("potential_energy", "f8", (), "energy")] = energy.potential
    return sample | whole_state(effects, local_time)


def by_name(values: dict[Column, Any]) -> dict[str, Any]:
    """The values by the names of their columns."""
    return {column.name: value for column, value in values.items()}
