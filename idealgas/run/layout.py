"""Contents of the log of a run: its columns and their values."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from idealgas.columns import (
    BLOCK,
    EVENT_COLUMNS,
    OUTSIDE,
    POSITION,
    TRIALS,
    VELOCITY,
    Arrays,
    Column,
    EventBatch,
    Kind,
    Values,
    event_columns,
)
from idealgas.effects import bundle
from idealgas.effects.bundle import Effects
from idealgas.engine.simulation import Simulation
from idealgas.log import Checkpoint, LogLayout, Wall
from idealgas.run.effects import exact_sums, observed_sums, restore_sums
from idealgas.run.energy import Energy, energy_of
from idealgas.scene import Scene
from idealgas.scene.walls import number_walls
from idealgas.state import Gas

TOTALS = tuple(Column(name, "i8") for name in ("events", "disc_collisions", "wall_hits", "trials"))
"""Columns of the numbers that every run counts from time 0."""

DIAGNOSTICS = (
    Column("kinetic_energy", "f8", unit="energy"),
    Column("momentum", "f8", (2,), "mass length/time"),
    Column("overlap", "f8"),
    Column("outside", "f8"),
)


def layout_of(
    scene: Scene, gas: Gas, effects: Effects, has_positions: bool, extra_state: Iterable[Column] = ()
) -> LogLayout:
    """Return the layout of the log of a scene; gas, effects: state at time 0.

    has_positions: whether discs have positions. extra_state: values of the method that checkpoints store.
    """
    x, y = ("periodic" if periodic else "none" for periodic in scene.properties.periodic)  # in the words of H5MD
    return LogLayout(
        walls=[Wall(wall.name, wall.start, wall.end) for wall in number_walls(scene)],
        boundary=(x, y),
        gravity=scene.properties.acceleration,
        disc_columns=bundle.disc_constants(effects),
        event_columns=row_columns(effects, has_positions) if scene.log.events else (),
        checkpoint_arrays=tuple(disc_state(gas, effects, has_positions)),
        checkpoint_values=(*totals(effects), *extra_state, *whole_state(effects)),
        observables=(*DIAGNOSTICS, *totals(effects), *extra_state, *observed(gas, effects)),
        snapshot_arrays=tuple(snapshot_state(gas, effects, has_positions)) if scene.log.snapshot_every else (),
        steered=scene.steering is not None,
        most_rows=2 * (scene.run.events or BLOCK),
        compression=scene.log.compression,
    )


def totals(effects: Effects) -> tuple[Column, ...]:
    """Columns of the numbers that a run with these effects counts from time 0."""
    return *TOTALS, *bundle.counted(effects)


def row_columns(effects: Effects, has_positions: bool = True) -> tuple[Column, ...]:
    """Columns of an event row with these effects."""
    has = {column.when for column in bundle.disc_state(effects)}
    return event_columns(*has, POSITION.when if has_positions else TRIALS)


def disc_state(gas: Gas, effects: Effects, has_positions: bool) -> Arrays:
    """Return the arrays with an entry per disc that a checkpoint stores; times count from the checkpoint."""
    motion = {POSITION: gas.position, VELOCITY: gas.velocity} if has_positions else {VELOCITY: gas.velocity}
    return motion | bundle.disc_state(effects)


def snapshot_state(gas: Gas, effects: Effects, has_positions: bool) -> Arrays:
    """Return the arrays with an entry per disc that a snapshot stores; they are also columns of events."""
    state = disc_state(gas, effects, has_positions)
    return {column: values for column, values in state.items() if column in EVENT_COLUMNS}


def write_steered(batch: EventBatch, discs: np.ndarray, simulation: Simulation) -> None:
    """Write a row for each of the given discs, whose velocities were changed at the start of the epoch."""
    rows = batch.rows(0, len(discs))
    rows.time[:], rows.disc[:], rows.partner[:], rows.kind[:] = simulation.time, discs, OUTSIDE, Kind.STEERED
    for column, values in snapshot_state(simulation.gas, simulation.effects, True).items():
        getattr(rows, column.name)[:] = values[discs]


def whole_state(effects: Effects) -> Values:
    """Return the values without an entry per disc that a checkpoint stores, including exact sums."""
    return bundle.whole_state(effects) | exact_sums(effects)


def restore(gas: Gas, effects: Effects, checkpoint: Checkpoint) -> Gas:
    """Return the gas at a checkpoint and set the effects to their state there; gas: the discs at any time."""
    arrays = checkpoint.arrays
    bundle.restore_effects(effects, arrays)
    restore_sums(effects, arrays)
    return replace(gas, position=arrays.get("position", gas.position).copy(), velocity=arrays["velocity"].copy())


def observed(gas: Gas, effects: Effects, local_time: float = 0.0) -> Values:
    """Return what a sample contains in addition to the diagnostics: energies, values of the effects, and sums."""
    energy = energy_of(gas, effects, local_time)
    sample: Values = {Column("energy", "f8", (), "energy"): energy.gas}
    parts = {effect.energy_part: effect.energy_column for effect, _ in bundle.present(effects)}
    for part in Energy._fields:
        if (column := parts.get(part)) is not None:
            sample[column] = getattr(energy, part)
    return sample | bundle.whole_state(effects, local_time) | observed_sums(effects)


def by_name(values: Mapping[Column, Any]) -> dict[str, Any]:
    """Return the values by the names of their columns."""
    return {column.name: value for column, value in values.items()}
