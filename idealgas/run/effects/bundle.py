"""All effects of a scene together, as the engines take them; the one list of them that a run has."""

from collections.abc import Iterator
from typing import Any

from idealgas.events import Arrays, Column, Values
from idealgas.log import Checkpoint
from idealgas.physics.effects import Effects
from idealgas.run.effects import gravity, periodic, piston, restitution, rotation, thermal, thermostat, wall
from idealgas.run.effects.slice import Slice
from idealgas.run.sums import with_sums
from idealgas.scene import Scene
from idealgas.state import Gas

SLICES = tuple(effect.SLICE for effect in (gravity, periodic, wall, rotation, restitution, thermal, piston, thermostat))


def make_effects(scene: Scene, gas: Gas) -> Effects:
    """The effects of a scene at time 0; None for those that it does not call for. gas: its discs at time 0."""
    effects = Effects(**{effect.field: effect.make(scene, gas) for effect in SLICES})
    gives = any(effect.gives_energy(state) for effect, state in present(effects))
    loses = any(effect.loses_energy(state) for effect, state in present(effects))
    inner = inner_energy(effects, gas)
    return with_sums(effects, scene, gas, gives_energy=gives, loses_energy=loses, inner_energy=inner)


def present(effects: Effects) -> Iterator[tuple[Slice, Any]]:
    """The effects that are there, with their states."""
    for effect in SLICES:
        if (state := getattr(effects, effect.field)) is not None:
            yield effect, state


def inner_energy(effects: Effects, gas: Gas) -> float:
    """Energy of the discs at time 0 beside their motion, which may become motion, mass length²/time²."""
    parts = ((effect.energy, state) for effect, state in present(effects))
    return sum(part.of(state, gas, 0.0) for part, state in parts if part is not None and part.inner)


def counted(effects: Effects) -> tuple[Column, ...]:
    """Totals of events that only these effects have."""
    return tuple(effect.counted for effect, _ in present(effects) if effect.counted is not None)


def disc_state(effects: Effects) -> Arrays:
    """What checkpoints keep of each disc, the effects' own arrays; times count from the checkpoint."""
    return {column: values for effect, state in present(effects) for column, values in effect.disc_state(state).items()}


def disc_constants(effects: Effects) -> Arrays:
    """What the log keeps of each disc at the start, beside motion, radius and mass."""
    return {column: values for effect, state in present(effects) for column, values in effect.constants(state).items()}


def whole_state(effects: Effects, local_time: float = 0.0) -> Values:
    """What checkpoints and samples keep of the effects as a whole; local_time: from the start of the epoch."""
    return {
        column: value
        for effect, state in present(effects)
        for column, value in effect.values(state, local_time).items()
    }


def restore_effects(effects: Effects, checkpoint: Checkpoint) -> None:
    """Give the effects the state that they had at a checkpoint."""
    for column, values in disc_state(effects).items():
        values[:] = checkpoint.arrays[column.name]
    for effect, state in present(effects):
        effect.restore(state, checkpoint.values)
